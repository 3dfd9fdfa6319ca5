"""The command line of all checks of this folder."""
import sys


def report(check, description, violations):
    """Print what violations(ROOT) finds, a line each; return the exit code."""
    if len(sys.argv) != 2:
        print(description, file=sys.stderr)
        return 2
    found = list(violations(sys.argv[1]))
    for path, number, message in found:
        print(f"{path}:{number}: {message}")
    print(f"{check}: {len(found)} violations")
    return 1 if found else 0
