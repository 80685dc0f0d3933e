# SPDX-License-Identifier: BSD-3-Clause
# The Python module, for catkin (catkin_python_setup); not to be called by hand.
from distutils.core import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=['soft_robot_lab'], package_dir={'': 'src/python'}))
