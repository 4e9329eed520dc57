"""`irc run`: in, requests as lines of JSON; out, answers, and a journal that outlives a crash."""
