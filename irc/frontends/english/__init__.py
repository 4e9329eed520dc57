"""Controlled English: steps, durations and orders told in sentences → the raw IR document.

No language model, no guessing: each sentence is understood by the grammar
(grammars/irc_grammars/english.lark) or refused with its place. See docs/english.md.
"""
