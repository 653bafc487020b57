"""Numbers on the command line."""

import argparse
import re


def port(text: str) -> int:
    """A TCP port, 0 for any."""
    return whole(text, 0, 65535)


def pixels(text: str) -> int:
    """A width in pixels."""
    return whole(text, 1, 1 << 20)


def scale(text: str) -> float:
    """A factor from 0.01 to 4."""
    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not 0.01 <= factor <= 4:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.01 to 4")
    return factor


def samples(text: str) -> int:
    """A number of things, at least one."""
    return whole(text, 1, 1 << 28)


def frame(text: str) -> int:
    """The number of a frame, from 0."""
    return whole(text, 0, 2**31 - 1)


def band(text: str) -> str:
    """I/N: band I, from 0, of N."""
    index, _, count = text.partition("/")
    if not re.fullmatch(r"[0-9]{1,9}/[0-9]{1,9}", text) or int(index) >= int(count):
        raise argparse.ArgumentTypeError(f"{text!r} is not I/N with I from 0 to N - 1, as in 0/4")
    return text


def whole(text: str, least: int, most: int) -> int:
    """A whole number within bounds."""
    if not text.isdecimal() or not least <= int(text) <= most:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {most}")
    return int(text)
