"""`irc run`: in, requests as lines of JSON; out, answers, and a journal that survives a crash."""
