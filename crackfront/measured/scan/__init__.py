"""Files of instruments, read, completed by what they do not state, and levelled."""
