"""What must hold of any module, for those who write one."""
