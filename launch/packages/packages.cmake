# Debian packages by CPack, where CATKIN_BUILD_BINARY_PACKAGE is on: see ../make_packages.sh. What catkin and its messages install has no
# component, so all of it is installed into one, and split_packages.cmake moves files into the others.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME soft-robot-lab)
set(CPACK_PACKAGE_VERSION ${${PROJECT_NAME}_VERSION})
set(CPACK_PACKAGE_CONTACT "${${PROJECT_NAME}_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL main dev study python)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/split_packages.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_SOFT_ROBOT_LAB_LIBRARIES ${CATKIN_GLOBAL_LIB_DESTINATION}) # for split_packages.cmake
set(same "(= ${CPACK_PACKAGE_VERSION})")

set(CPACK_DEBIAN_MAIN_PACKAGE_NAME soft-robot-lab)
set(CPACK_COMPONENT_MAIN_DESCRIPTION "silicone robots: simulated, driven, tracked and taught
ROS 1 nodes, programs and robots for a soft-robot lab: a silicone robot is
described once, checked for casting, simulated accurately and fast, driven on
a rig, tracked by RGB-D cameras and taught to reach goals.")
set(CPACK_DEBIAN_MAIN_PACKAGE_DEPENDS "python3, python3-soft-robot-lab ${same}, rviz, rosbash, python3-roslaunch, python3-rostopic, python3-rosservice, \
python3-rosnode, python3-rosparam, python3-rosbag, python3-rosmsg, python3-dynamic-reconfigure, python3-tf2-msgs, python3-yaml, rosout, gnuplot-nox | gnuplot")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME soft-robot-lab-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "silicone robots: headers
Headers of messages, of the cores and for plugins of soft-robot-lab.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "soft-robot-lab ${same}, libeigen3-dev, libroscpp-dev, libstd-msgs-dev, libgeometry-msgs-dev, libsensor-msgs-dev, \
libvisualization-msgs-dev, libactionlib-dev, libyaml-cpp-dev, libopencv-dev, nlohmann-json3-dev, pluginlib-dev, ros-message-generation")

set(CPACK_DEBIAN_STUDY_PACKAGE_NAME soft-robot-lab-study)
set(CPACK_COMPONENT_STUDY_DESCRIPTION "silicone robots: experiments and charts
Repeats the experiments of the results page of soft-robot-lab, and draws its
charts.")
set(CPACK_DEBIAN_STUDY_PACKAGE_DEPENDS "soft-robot-lab ${same}")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-soft-robot-lab)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "silicone robots: Python module
Messages, a client of sessions, and the simulator as a module.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, python3-rospy, python3-genpy, python3-std-msgs, python3-geometry-msgs, \
python3-sensor-msgs, python3-visualization-msgs, python3-diagnostic-msgs, python3-std-srvs, python3-actionlib, python3-actionlib-msgs, python3-rosgraph-msgs")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "soft-robot-lab ${same}")
include(CPack)
