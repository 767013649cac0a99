// Empty: its target compiles the headers that all plugins share.
