"""The MCP server: in, calls of tools by an agent; out, the documents of the commands, as results.

`tools` has the tools as plain functions; `server` serves them over standard input and output.
"""
