"""How far it goes: frames beyond memory, and plans for clusters."""
