"""How far two results are apart."""

import bisect


def deviation(expected, points):
    """The greatest difference of two lists of (x, y), at the x of the second, in shares of the range of the first.

    Between the points of the first list, y is on a straight line; of two points at one x, the nearer one counts.
    """
    if not points or any(y != y for _, y in points):
        return float("inf")
    xs = [x for x, _ in expected]
    ys = [y for _, y in expected]
    extent = max(ys) - min(ys) or max(map(abs, ys)) or 1.0

    def distance(x, y):
        low, high = bisect.bisect_left(xs, x), bisect.bisect_right(xs, x)
        if low < high:
            return min(abs(y - value) for value in ys[low:high])
        right = min(max(low, 1), len(xs) - 1)
        share = (x - xs[right - 1]) / (xs[right] - xs[right - 1])
        return abs(y - ys[right - 1] - share * (ys[right] - ys[right - 1]))

    return max(distance(x, y) for x, y in points) / extent
