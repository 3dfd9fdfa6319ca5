"""Inside LinuxCNC: poses of the world, and what the pins say there (system Python with LinuxCNC's modules)."""
import hal


class Pins:
    """Pins of the kinematics module by their names, and of what it moves.

    @param words      of the axes, by joint: "XYZAC"
    @param axes       names of the axes, by joint: ["X", "C1"]
    """

    def __init__(self, operation, module, words, axes):
        self.operation, self.module, self.words = operation, module, words
        self.world = [f"axis.{word.lower()}.pos-cmd" for word in words]
        self.joints = [f"joint.{j}.motor-pos-cmd" for j in range(len(words))]
        self.offset = [f"motion.tooloffset.{axis}" for axis in "xyz"]
        self.corrections = [f"{module}.correction-{axis.lower()}" for axis in axes]

    def get(self, name):
        return hal.get_value(f"{self.module}.{name}")

    def set(self, name, value):
        hal.set_p(f"{self.module}.{name}", str(value))

    def enable(self, wanted):
        self.set("enable", int(wanted))
        self.operation.until(lambda: self.get("enabled") == wanted, "the ramp")

    def tool(self, number):
        if number == 0:
            self.operation.mdi("G49")
        else:
            self.operation.mdi(f"T{number} M6")
            self.operation.mdi(f"G43 H{number}")

    def words_of(self, world, offset):
        """Words of a program: with G43 they are those of the tool's point."""
        shift = dict(zip("XYZ", offset))
        return " ".join(f"{word}{value - shift.get(word, 0):.10f}" for word, value in zip(self.words, world))

    def go(self, world, offset, move="G0"):
        """To a position of the world, and until the joints stand; what is there: see here()."""
        self.operation.mdi(f"{move} {self.words_of(world, offset)}")
        get = hal.get_value
        self.operation.until(lambda: max(abs(get(name) - place) for name, place in zip(self.world, world)) < 1e-6,
                             f"world at {world}")
        return self.here()

    def joints_now(self):
        return [hal.get_value(name) for name in self.joints]

    def here(self):
        """Tool offset, world, joints and corrections, uncertainty, status and part enabled, once nothing moves."""
        before = None
        while True:
            self.operation.cycles(12)
            now = [hal.get_value(name) for name in self.offset + self.world + self.joints + self.corrections]
            # Rounding may change from one cycle to the next.
            if before and max(abs(a - b) for a, b in zip(now, before)) < 1e-11:
                return now + [self.get(name) for name in ("uncertainty-um", "status", "enabled")]
            before = now
