// SPDX-License-Identifier: BSD-3-Clause
// The program of one node: a process of its own, whose code lies in a library with that of others.
namespace soft_robot_lab {
int SOFT_ROBOT_LAB_NODE(int argc, char** argv);
}

int main(int argc, char** argv) { return soft_robot_lab::SOFT_ROBOT_LAB_NODE(argc, argv); }
