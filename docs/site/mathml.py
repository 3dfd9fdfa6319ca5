"""Formulas as MathML: browsers set it themselves, without a script, a font or another host."""

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.writers.html5 import HTML5Translator

# An operator alone in braces has no room around it: `x{\uparrow}`.
BRACED = re.compile(r"<mrow><mo>([^<]*)</mo></mrow>")


def formula(node: nodes.Element, display: str) -> str:
    return BRACED.sub(r'<mo lspace="0" rspace="0">\1</mo>', convert(node.astext(), display=display))


def visit_inline(self: HTML5Translator, node: nodes.Element) -> None:
    self.body.append(formula(node, "inline"))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.Element) -> None:
    self.body.append(f"{self.starttag(node, 'div', CLASS='math-block')}{formula(node, 'block')}</div>\n")
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
