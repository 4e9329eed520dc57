"""Controlled English: in, sentences about steps, durations and orders; out, the raw IR document.

No language model, no guessing: each sentence is understood by the grammar
(grammars/irc_grammars/english.lark) or refused with its place. See docs/english.md.
"""
