"""The tutorial in examples/python: each script runs and gives the promised result."""

import os
import pathlib
import re
import subprocess
import sys

EXAMPLES = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "examples" / "python"


def output_of(script, *arguments):
    return subprocess.run([sys.executable, "-B", EXAMPLES / script, *arguments], check=True,
                          stdout=subprocess.PIPE, text=True).stdout


def test_a_hand_that_presses_two_millimetres_into_a_head_feels_the_spring():
    text = output_of("feel_a_ct.py")
    forces = [float(f) for f in re.findall(r"force (\d\.\d+) N", text)]
    assert forces[0] == 0 and 1.0 < forces[-1] < 1.7  # 0.8 N/mm, 2 mm deep along a ray
    assert "Mesh(" in text


def test_what_is_felt_lies_within_a_tenth_of_a_millimetre_of_the_analytic_surface():
    rows = [line.split(",") for line in output_of("script_an_experiment.py").splitlines()[1:]]
    assert len(rows) == 4 and all(int(row[2]) > 500 for row in rows)
    assert all(float(row[3]) < 0.1 for row in rows)


def test_a_device_in_python_comes_to_rest_on_the_floor():
    # However late its machine, the example goes on until the spring carries the weight of 0.98 N.
    assert output_of("write_a_device.py").splitlines()[-2] == "rests at -1.0 mm with 1.0 N"
