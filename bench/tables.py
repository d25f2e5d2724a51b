"""What the table_*.py programs share: tables as the docs have them."""


def table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def ratio(spread):
    return f'{spread["median"]:.2f} ({spread["p1"]:.2f}-{spread["p99"]:.2f})'
