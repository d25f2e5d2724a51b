"""The tables of figures, one module per bench. A module's TABLES maps a table's name to the function that writes it.

Such a function takes the loaded results, in the order in which the page names them, and returns lines of Markdown.
"""
