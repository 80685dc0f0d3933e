// SPDX-License-Identifier: BSD-3-Clause
constexpr int kMostWorkers = 100;
double number(const std::string& text) { return std::stod(text); }
CLI::App app;
