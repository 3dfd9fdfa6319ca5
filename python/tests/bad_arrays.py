"""Arguments that are no array of axis commands, and what has to be said about them."""

import numpy

#: What cannot be commands of a machine with five axes.
BAD_POSITIONS = [
    [1, 2], [[1, 2]], "abc", [["a"] * 5], numpy.zeros((2, 5), complex), numpy.full((2, 5), numpy.nan), [[numpy.inf] * 5],
    numpy.float64(3), {}, object(), numpy.zeros((1, 2, 5)), numpy.array([None] * 5), [[1, 2, 3, 4, 5], [1, 2]],
]

#: The same commands in other forms.
GOOD_POSITIONS = [
    numpy.ones((2, 5)), numpy.ones((2, 5), order="F"), numpy.ones((2, 5), int), numpy.ones((2, 5), "float32"),
    numpy.ones((4, 10))[::2, ::2], [[1] * 5] * 2, ((1, 1, 1, 1, 1),) * 2, numpy.ones((2, 5))[::-1],
    numpy.ones((2, 5)).astype(">f8"), numpy.broadcast_to(numpy.ones(5), (2, 5)),
]
