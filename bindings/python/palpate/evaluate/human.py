"""A model of a person's hand: a mass, a damper and a spring towards a target that trembles and reacts late to the force."""

import dataclasses

import numpy
import scipy.signal

RATE, SUBSTEPS = 1000, 5  # [Hz] of what is written, and steps of the motion in each
REACH = 15.0  # [mm] root mean square of the willed motion along the plane
LIFT, PERIOD, PRESSED = 6.0, 2.0, 0.8  # [mm] above the plane between presses, their period [s], and the part of it that presses
FLESH, SOFT = 1.5, 0.01  # [N/mm], [s/mm] spring and damping (Hunt and Crossley 1975) of what is between hand and tip; assumed
SMOOTH = 1.0  # [mm/s] below which friction falls to 0, so that a slow hand does not chatter


@dataclasses.dataclass(frozen=True)
class Human:
    """Mass, damping and stiffness: fitted to one trial of one person who held a haptic handle (van Beek et al. 2015, Scientific Reports
    5, 18004, Fig. 3). Tremor of the hand: 50 to 200 µm root mean square, commonly at 8 to 12 Hz (reviewed in PMC3989364), and 182 µm in
    surgery (Riviere and Jensen 2000). Willed motion: 98.9 % of its power is below 2 Hz (Riviere, Rader and Khosla 1997). Delay: of a
    simple reaction to touch (Robinson 1934). The gain is assumed."""

    mass: float = 0.554  # [kg]
    damping: float = 6.45  # [N s/m]
    stiffness: float = 135.0  # [N/m]
    tremor: float = 0.1  # [mm] root mean square of the free hand, along an axis
    band: tuple = (8, 12)  # [Hz]
    willed: float = 2.0  # [Hz]
    delay: float = 0.155  # [s]
    gain: float = 2.0  # [1/s] at which the target makes up for a force that is not the wanted one


def in_band(signal, band, kind):
    return scipy.signal.sosfiltfilt(scipy.signal.butter(2, band, kind, fs=RATE, output="sos"), signal, axis=0)


def noise(random, count, band, kind):
    """Of root mean square 1 along each axis, (count, 3)."""
    made = in_band(random.standard_normal((count + 2 * RATE, 3)), band, kind)[RATE:-RATE]
    return made / numpy.sqrt((made**2).mean(axis=0))


def trembling(human, random, count):
    """[mm] What tremor adds to a target, (count, 3), so that a free hand trembles by human.tremor: its mass, damper and spring pass on
    only a fifth of what the target does at 10 Hz."""
    hand = human.tremor * noise(random, count + 2 * RATE, human.band, "bandpass")
    s = 2j * numpy.pi * numpy.fft.rfftfreq(len(hand), 1 / RATE)[:, None]
    given = human.stiffness + human.damping * s
    return numpy.fft.irfft(numpy.fft.rfft(hand, axis=0) * (human.mass * s**2 + given) / given, len(hand), axis=0)[RATE:-RATE]


def press(human, random, seconds, wanted, wall, friction):
    """(tip [mm], force on the hand [N]) at RATE, (n, 3), of a hand that strokes the plane z = 0 and presses with `wanted` [N] against it,
    and lifts off in between. The plane is a spring of `wall` [N/mm] with Coulomb friction, and the flesh of the hand one behind it."""
    count, step = int(seconds * RATE), 1 / (RATE * SUBSTEPS)
    presses = numpy.arange(count) / RATE % PERIOD >= (1 - PRESSED) * PERIOD
    target = trembling(human, random, count) + REACH * noise(random, count, human.willed / 4, "lowpass") * [1, 1, 0]
    depth = 1000 * wanted / human.stiffness  # [mm] of the target that gives the wanted force
    target[:, 2] += in_band(numpy.where(presses, -depth, LIFT), human.willed, "lowpass")
    way = numpy.gradient(target, 1 / RATE, axis=0)
    together = wall * FLESH / (wall + FLESH)
    late, more, place, speed = int(human.delay * RATE), 0.0, target[0].copy(), numpy.zeros(3)
    tips, forces = numpy.empty((count, 3)), numpy.zeros((count, 3))
    for tick in range(count):
        if presses[tick] and tick >= late and forces[tick - late, 2] > 0:
            more += human.gain * (wanted - forces[tick - late, 2]) / human.stiffness  # [mm], as a thousandth of a second has passed
        for _ in range(SUBSTEPS):
            normal = max(0.0, -together * min(0.0, place[2]) * (1 - SOFT * speed[2]))
            rubs = friction * normal / max(SMOOTH, float(numpy.hypot(speed[0], speed[1])))
            force = numpy.array([-rubs * speed[0], -rubs * speed[1], normal])
            pull = human.stiffness * (target[tick] - [0, 0, more] - place) + human.damping * (way[tick] - speed)  # [mN]
            speed = speed + step * (1000 * force + pull) / human.mass
            place = place + step * speed
        tips[tick], forces[tick] = [*place[:2], -normal / wall if normal else max(place[2], 0.0)], force
    return tips, forces
