"""Formulas as MathML, which browsers draw themselves: no script and no font is fetched."""

from typing import Any

from docutils import nodes
from docutils.utils.math import latex2mathml


def _mathml(text: str, *, inline: bool) -> str:
    return latex2mathml.tex2mathml(text, as_block=not inline)


def inline(visitor: Any, node: nodes.math) -> None:
    """A formula in a line of text."""
    visitor.body.append(_mathml(node.astext(), inline=True))
    raise nodes.SkipNode


def block(visitor: Any, node: nodes.math_block) -> None:
    """A formula on lines of its own."""
    visitor.body.append(f'<div class="formula">{_mathml(node.astext(), inline=False)}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
