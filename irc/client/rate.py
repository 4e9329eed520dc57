"""Rates: at most this many requests and tokens a minute, and pauses that a service asks for."""

from __future__ import annotations

import asyncio

from irc.targets import Budget

SECONDS = 60.0


class Bucket:
    """A stock that fills up evenly within a minute; what is taken waits until it is there.

    One request may need more than the whole stock: then it waits for a full one, and those that
    follow wait for the rest.
    """

    def __init__(self, per_minute: float) -> None:
        self.per_minute = per_minute
        self._level = per_minute
        self._at: float | None = None

    def _fill(self, now: float) -> None:
        if self._at is not None:
            grown = (now - self._at) * self.per_minute / SECONDS
            self._level = min(self.per_minute, self._level + grown)
        self._at = now

    def missing(self, amount: float, now: float) -> float:
        """The seconds until the amount is there; 0 where it is."""
        self._fill(now)
        lack = min(amount, self.per_minute) - self._level
        return max(0.0, lack) * SECONDS / self.per_minute

    def take(self, amount: float, now: float) -> None:
        """Takes an amount; a negative one gives back what was not used."""
        self._fill(now)
        self._level = min(self.per_minute, self._level - amount)


class Rate:
    """The limits on requests and on tokens of one client, and its pause."""

    def __init__(self, requests: float | None, tokens: float | None) -> None:
        self._requests = None if requests is None else Bucket(requests)
        self._tokens = None if tokens is None else Bucket(tokens)
        self._clock = Budget()
        self._until = 0.0

    def hold(self, seconds: float) -> None:
        """Lets no request begin for some seconds."""
        self._until = max(self._until, self._clock.elapsed + seconds)

    async def take(self, tokens: int) -> None:
        """Waits until a request of about that many tokens may begin."""
        while (wait := self._missing(tokens, self._clock.elapsed)) > 0:
            await asyncio.sleep(wait)
        for bucket, amount in ((self._requests, 1.0), (self._tokens, float(tokens))):
            if bucket is not None:
                bucket.take(amount, self._clock.elapsed)

    def used(self, expected: int, tokens: int) -> None:
        """Corrects the stock of tokens by what a request took in fact."""
        if self._tokens is not None and tokens:
            self._tokens.take(float(tokens - expected), self._clock.elapsed)

    def _missing(self, tokens: int, now: float) -> float:
        waits = [self._until - now]
        if self._requests is not None:
            waits.append(self._requests.missing(1.0, now))
        if self._tokens is not None:
            waits.append(self._tokens.missing(float(tokens), now))
        return max(waits)
