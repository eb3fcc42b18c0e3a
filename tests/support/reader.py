"""Reads a page as a browser would: elements, attributes and text, with balanced tags."""

from __future__ import annotations

from dataclasses import dataclass, field
from html.parser import HTMLParser

VOID = {
    "meta",
    "link",
    "br",
    "hr",
    "img",
    "input",
    "area",
    "base",
    "col",
    "embed",
    "source",
    "track",
    "wbr",
}


@dataclass
class Element:
    """A tag with its attributes and everything inside it."""

    name: str
    attributes: dict[str, str]
    parent: Element | None = None
    children: list = field(default_factory=list)

    def all(self, name: str = "", **attributes: str):
        """The elements inside with this name and these attributes (class_ for class)."""
        wanted = {key.rstrip("_").replace("_", "-"): value for key, value in attributes.items()}
        for child in self.children:
            if not isinstance(child, Element):
                continue
            if name in ("", child.name) and all(
                child.attributes.get(key) == value for key, value in wanted.items()
            ):
                yield child
            yield from child.all(name, **attributes)

    @property
    def text(self) -> str:
        """All words inside, spaces joined."""
        parts = (child if isinstance(child, str) else child.text for child in self.children)
        return " ".join(" ".join(parts).split())


class Reader(HTMLParser):
    """Builds the tree; a tag that closes what is not open is an error."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.root = Element("", {})
        self.at = self.root

    def handle_starttag(self, tag, attrs):
        element = Element(tag, {key: value or "" for key, value in attrs}, self.at)
        self.at.children.append(element)
        if tag not in VOID:
            self.at = element

    def handle_startendtag(self, tag, attrs):
        self.at.children.append(Element(tag, {k: v or "" for k, v in attrs}, self.at))

    def handle_endtag(self, tag):
        if tag != self.at.name:
            raise ValueError(f"</{tag}> closes <{self.at.name}> at {self.getpos()}")
        self.at = self.at.parent

    def handle_data(self, data):
        self.at.children.append(data)


def read(html: str) -> Element:
    """The tree of a page; ValueError when its tags are not balanced."""
    reader = Reader()
    reader.feed(html)
    reader.close()
    if reader.at is not reader.root:
        raise ValueError(f"<{reader.at.name}> is never closed")
    return reader.root
