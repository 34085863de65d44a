"""Changes of a document's bytes that know nothing of its meaning."""

import random
import re

TOKEN = re.compile(rb'"(?:[^"\\]|\\.)*"|-?[0-9][0-9.eE+-]*|[\[\]{}:,]|true|false|null')

LITERALS = (
    *(b"NaN", b"Infinity", b"-Infinity", b"1e400", b"-1e400", b"1e308", b"-1e308", b"5e-324", b"-0.0", b"0", b"-1"),
    *(b"1" + b"0" * 400, b"9" * 5000, b"1." + b"0" * 3000 + b"1", b"1e-999", b"01", b"+1", b".5", b"1.", b"0x10"),
    *(b"null", b"true", b"false", b"[]", b"{}", b'""', b'"\\ud800"', b'"\\u0000"', b'"\\u001b[2J"', b'"\xff"', b"\x00"),
    *(b"[" * 40 + b"]" * 40, b"[" * 5000 + b"]" * 5000, b'{"a":' * 3000, b'{"a":1,"a":2}', b'"' + b"x" * 5000 + b'"'),
    *(b'{"__class__":"os.system"}', b"//", b"/**/", b"'a'", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"{", b"}", b",", b":"),
)


def mutate(text: bytes, other: bytes, chance: random.Random) -> bytes:
    """Return a document changed in one to four places; other: one to take pieces from."""
    for _ in range(min(1 + int(chance.expovariate(1.0)), 4)):
        text = chance.choice(_CHANGES)(text, other, chance)
    return text


def _flip(text: bytes, other: bytes, chance: random.Random) -> bytes:
    if not text:
        return text
    at = chance.randrange(len(text))
    return text[:at] + bytes([text[at] ^ (1 << chance.randrange(8))]) + text[at + 1 :]


def _truncate(text: bytes, other: bytes, chance: random.Random) -> bytes:
    return text[: chance.randrange(len(text) + 1)]


def _cut(text: bytes, other: bytes, chance: random.Random) -> bytes:
    start, length = chance.randrange(len(text) + 1), int(chance.expovariate(0.05))
    return text[:start] + text[start + length :]


def _repeat(text: bytes, other: bytes, chance: random.Random) -> bytes:
    start, length = chance.randrange(len(text) + 1), int(chance.expovariate(0.02))
    return text[: start + length] + text[start : start + length] * chance.randrange(1, 4) + text[start + length :]


def _splice(text: bytes, other: bytes, chance: random.Random) -> bytes:
    return text[: chance.randrange(len(text) + 1)] + other[chance.randrange(len(other) + 1) :]


def _insert(text: bytes, other: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice(LITERALS) + text[at:]


def _replace_token(text: bytes, other: bytes, chance: random.Random) -> bytes:
    if not (found := list(TOKEN.finditer(text))):
        return text
    token = chance.choice(found)
    return text[: token.start()] + chance.choice(LITERALS) + text[token.end() :]


def _swap_tokens(text: bytes, other: bytes, chance: random.Random) -> bytes:
    if len(found := list(TOKEN.finditer(text))) < 2:
        return text
    first, second = sorted(chance.sample(found, 2), key=lambda token: token.start())
    between = text[first.end() : second.start()]
    return text[: first.start()] + second.group() + between + first.group() + text[second.end() :]


_CHANGES = (_flip, _truncate, _cut, _repeat, _splice, _insert, _replace_token, _swap_tokens)
