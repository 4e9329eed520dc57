"""The language server: what `irc check`, `irc fmt` and `irc explain-code` say, in an editor.

`irc.lsp.server` speaks the protocol (through pygls, which nothing else here imports); the other
modules know texts and offsets only.
"""
