"""The language server: `irc check`, `irc fmt` and `irc explain-code` in an editor.

`irc.lsp.server` speaks the protocol through pygls, which no other module here imports. The other
modules know only texts and offsets.
"""
