"""The cheapest assignment of rows to columns."""

from collections.abc import Sequence


def cheapest_assignment(costs: Sequence[Sequence[int]]) -> list[int]:
    """Return a column of its own for every row, at the least total cost; of several such lists the first in order.

    The Hungarian method (Kuhn 1955): rows join one at a time, each by the cheapest path of exchanges.

    Args:
        costs: [rows, columns], none negative, with at least as many columns as rows.
    """
    rows, columns = len(costs), max(map(len, costs), default=0)
    # The columns are the digits of a number that decides between equal costs.
    weights = [
        [
            cost * columns**rows + column * columns ** (rows - 1 - row)
            for column, cost in enumerate(line)
        ]
        for row, line in enumerate(costs)
    ]
    far = 1 + sum(map(sum, weights))
    # No weight is less than the sum of its row's and its column's price, and those of the assignment equal it.
    row_price, column_price = [0] * rows, [0] * columns
    row_of: dict[int, int] = {}
    for joining in range(rows):
        row, path = joining, list[int]()
        gaps, previous = [far] * columns, [-1] * columns
        while True:
            free = [column for column in range(columns) if column not in path]
            for column in free:
                gap = weights[row][column] - row_price[row] - column_price[column]
                if gap < gaps[column]:
                    gaps[column], previous[column] = gap, path[-1] if path else -1
            nearest = min(free, key=gaps.__getitem__)
            gap = gaps[nearest]
            row_price[joining] += gap
            for column in path:
                row_price[row_of[column]] += gap
                column_price[column] -= gap
            for column in free:
                gaps[column] -= gap
            if nearest not in row_of:
                break
            path.append(nearest)
            row = row_of[nearest]
        column = nearest
        while column >= 0:
            earlier = previous[column]
            row_of[column] = row_of[earlier] if earlier >= 0 else joining
            column = earlier
    return sorted(row_of, key=row_of.__getitem__)
