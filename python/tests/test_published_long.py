"""The published study that takes longest, from paths over seven parts to their deviations: as test_published.py."""

from test_published import same_bytes


def test_the_longest_study_is_that_of_the_command(tmp_path):
    same_bytes("liu", tmp_path)
