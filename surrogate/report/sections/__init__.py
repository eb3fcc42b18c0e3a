"""Sections of the page, one a file: each turns the content into sentences, tables, figures."""
