"""YAML 1.2 as tests write and read it."""

import io

from ruamel.yaml import YAML


def from_yaml(text):
    """Content of a text in YAML."""
    return YAML(typ="safe", pure=True).load(text)


def to_yaml(content):
    """Text in YAML of a content, a key a line."""
    writer = YAML(typ="safe", pure=True)
    writer.default_flow_style = False
    stream = io.StringIO()
    writer.dump(content, stream)
    return stream.getvalue()
