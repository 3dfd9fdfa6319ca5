"""Formulas as MathML: browsers set it themselves, without a script, a font or another host."""

from docutils import nodes
from docutils.utils.math import latex2mathml, wrap_math_code
from sphinx.writers.html5 import HTML5Translator


def _markup(node: nodes.Element, block: bool) -> str:
    code = node.astext()
    as_block = latex2mathml.tex2mathml(wrap_math_code(code, True) if block else code, as_block=block)
    return as_block.replace("<math ", '<math dir="ltr" ', 1)


def visit_inline(self: HTML5Translator, node: nodes.Element) -> None:
    self.body.append(_markup(node, False))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.Element) -> None:
    self.body.append(self.starttag(node, "div", CLASS="math-block") + _markup(node, True) + "</div>\n")
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
