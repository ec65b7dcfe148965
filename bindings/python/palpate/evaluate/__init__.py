"""Experiments: a module for each, with a question, a table, figures and checked claims. Run them with
`palpate evaluate NAME` or `python3 -m palpate.evaluate NAME` (docs/evaluation.md)."""
