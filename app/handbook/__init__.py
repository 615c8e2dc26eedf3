"""The handbook: pages that need no network, from Markdown and from the modules' declarations."""
