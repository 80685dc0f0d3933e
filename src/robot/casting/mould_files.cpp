// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "make_mould.h"
#include "mould_picture.h"
#include "stl_file.h"
#include "three_mf.h"
#include "settings/kept_files.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kDescription = "mould.json";
constexpr const char* kPartEndings[] = {".stl", ".3mf", ".step", ".png"};

// Turning parts and directions leaves zeros with a sign, which a reader takes for an error.
Eigen::Vector3d without_negative_zeros(const Eigen::Vector3d& value) { return value + Eigen::Vector3d::Zero(); }

OrderedJson triple(const Eigen::Vector3d& value) {
  const Eigen::Vector3d shown = without_negative_zeros(value);
  return {shown.x(), shown.y(), shown.z()};
}

OrderedJson part_json(const MouldPart& part) {
  OrderedJson json;
  json["name"] = part.name;
  json["stl"] = part.name + ".stl";
  json["3mf"] = part.name + ".3mf";
  json["step"] = part.name + ".step";
  json["volume_m3"] = part.surface.volume_m3();
  json["size_m"] = triple(part.size_m());
  json["triangles"] = part.surface.triangle_count();
  json["watertight"] = true;  // make_surface makes no other
  json["fits_printer"] = part.fits_printer;
  json["thinnest_m"] = std::isfinite(part.thinnest_m) ? OrderedJson(part.thinnest_m) : OrderedJson(nullptr);
  for (int i = 0; i < 3; ++i) json["rotation"].push_back(triple(part.rotation.row(i).transpose()));
  json["offset_m"] = triple(part.offset_m);
  return json;
}

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed;
  text.precision(digits);
  text << value;
  return text.str();
}

std::string parts_table(const Mould& mould) {
  std::string rows;
  for (const MouldPart& part : mould.parts) {
    const Eigen::Vector3d mm = 1000 * part.size_m();
    rows += "<tr><td>" + part.name + ".stl</td><td>" + rounded(mm.x(), 1) + " x " + rounded(mm.y(), 1) + " x " +
            rounded(mm.z(), 1) + " mm</td><td>" + rounded(1e6 * part.surface.volume_m3(), 1) + " ml</td></tr>\n";
  }
  return "<table><tr><th>part</th><th>size as it stands on the bed</th><th>volume</th></tr>\n" + rows + "</table>\n";
}

std::string way_text(const MouldPlan& plan) {
  std::ostringstream way;
  way << "[" << without_negative_zeros(plan.direction).transpose() << "]";
  return way.str();
}

// From the mix to the robot, in two pours.
std::vector<std::string> lid_steps(const Mould& mould) {
  const double first_ml = 1e6 * mould.plan.first_pour_m3, all_ml = 1e6 * mould.robot_volume_m3;
  return {"Stand base and lid_tray on a level table, open side up. Close the core's air holes with wax.",
          "Pour half of the mix into base, up to its rim: " + rounded(first_ml, 1) + " ml stay in it.",
          "Lower the core, one end first, until its feet stand on the rim. Scrape off what it presses out.",
          "Let it cure as its maker states. Open the air holes, draw the core out, and pull the body out along " +
              way_text(mould.plan) + " of the robot's axes.",
          "Mix the rest anew, and pour " + rounded(all_ml - first_ml, 1) + " ml into lid_tray, up to its rim.",
          "Lay the body on it, open side down, where it fits the outline, before the lid cures.",
          "Let it cure, and pull both out. Pierce the wall where air shall come in."};
}

std::vector<std::string> assembly_steps(const Mould& mould) {
  if (mould.plan.two_part)
    return {"Put both halves together: the " + std::to_string(mould.plan.keys) +
                " pegs of lower_half go into their sockets.",
            "Close them with " + std::to_string(mould.plan.bolts) + " bolts through the flanges.",
            mould.plan.sprue ? "Stand the mould on its end: the sprue is above."
                             : "Stand the mould on its end: the opening is above, and level."};
  std::vector<std::string> steps{"Put the mould on a level table, open side up."};
  if (!mould.plan.air_holes.empty())
    steps.push_back("Close the " + std::to_string(mould.plan.air_holes.size()) +
                    " air holes from below with wax or tape.");
  return steps;
}

// Straws that lie in the mould before the silicone is poured.
std::vector<std::string> sheath_steps(const MouldPlan& plan) {
  if (plan.sheaths.empty()) return {};
  std::vector<std::string> steps{"Close both ends of each sheath with a rod or wax, and lay them on their shelves:"};
  for (const SheathPiece& piece : plan.sheaths)
    steps.back() += " " + piece.cable + ", " + rounded(1000 * piece.length_m(), 1) + " mm, outside " +
                    rounded(2000 * piece.radius_m, 1) + " mm;";
  steps.back().back() = '.';
  if (plan.flash_m3 > 0)
    steps.push_back("Press modelling clay into the slots above them, in the mould's teeth, up to the rim: together " +
                    rounded(1e6 * plan.flash_m3, 2) + " ml. Or cut this silicone off afterwards.");
  return steps;
}

std::string mix_step(const Silicone& silicone) {
  return "Mix " + rounded(silicone.part_a_g, 1) + " g of part A with " + rounded(silicone.part_b_g, 1) +
         " g of part B: together " + rounded(silicone.mass_g, 1) + " g.";
}

std::string pour_step(const Mould& mould) {
  const size_t vents = mould.plan.vents.size();
  const std::string holds = " The cavity holds " + rounded(1e6 * mould.robot_volume_m3, 1) + " ml.",
                    rises =
                        vents == 0 ? "" : " Wait until it rises in each of the " + std::to_string(vents) + " vents.";
  if (mould.plan.sprue) return "Pour slowly through the sprue, until it stays full." + rises + holds;
  return "Pour slowly in one place, until the silicone stands level with the rim." + rises + holds +
         " Scrape off what stands above.";
}

// From the mix to the robot, in one pour.
std::vector<std::string> pour_steps(const Mould& mould) {
  std::vector<std::string> steps{pour_step(mould), "Let it cure as its maker states."};
  if (!mould.plan.air_holes.empty()) steps.push_back("Open the air holes.");
  steps.push_back((mould.plan.two_part ? "Take out the bolts, and pull the halves apart along " + way_text(mould.plan) +
                                             " of the robot's axes."
                                       : "Pull the robot out along " + way_text(mould.plan) + " of its own axes."));
  if (mould.plan.sprue || !mould.plan.vents.empty())
    steps.push_back("Cut off the silicone of " + std::string(mould.plan.sprue ? "sprue and vents" : "the vents") +
                    ", together " + rounded(1e6 * mould.plan.flash_m3, 2) + " ml.");
  steps.push_back(mould.plan.sheaths.empty()
                      ? "Sheaths and cables are not part of this mould: lead them through afterwards."
                      : "Cut the sheaths where they cross gaps, and lead the cables through.");
  return steps;
}

std::vector<std::string> steps_of(const Mould& mould) {
  std::vector<std::string> steps{"Print the parts as they stand in their files, in millimetres.",
                                 "Smooth what forms the silicone, and spray it with a release agent."};
  const auto add = [&](const std::vector<std::string>& more) { steps.insert(steps.end(), more.begin(), more.end()); };
  if (!mould.plan.lid) add(assembly_steps(mould));
  add(sheath_steps(mould.plan));
  add({mix_step(mould.silicone), "Remove air from the mix in a vacuum."});
  add(mould.plan.lid ? lid_steps(mould) : pour_steps(mould));
  if (mould.plan.inserts > 0)
    add({"Cast the pieces that close it apart, " + std::to_string(mould.plan.inserts) +
         ", and bond them in with fresh silicone."});
  return steps;
}

std::string pictures_html(const Mould& mould) {
  std::string figures;
  for (const MouldPart& part : mould.parts)
    figures += "<figure><img src=\"" + part.name + ".png\" alt=\"" + part.name + "\"><figcaption>" + part.name +
               ".stl, as it stands on the bed</figcaption></figure>\n";
  return figures +
         "<figure><img src=\"robot.png\" alt=\"robot\"><figcaption>What is cast, as it lies in the mould"
         "</figcaption></figure>\n";
}

fs::path place_of(const std::string& folder) {
  const fs::path place = fs::absolute(folder).lexically_normal();
  return place.has_filename() ? place : place.parent_path();
}

[[noreturn]] void refuse_writing(const fs::path& folder) {
  throw std::runtime_error(folder.string() + ": cannot be written: " + std::strerror(errno));
}

// The nearest folder above that there is must let others be made in it.
void require_writable(const fs::path& place) {
  fs::path above = place.parent_path();
  while (!fs::exists(above) && above.has_relative_path()) above = above.parent_path();
  if (!fs::is_directory(above)) throw std::runtime_error(above.string() + ": is no folder");
  std::string probe = (above / "mould.XXXXXX").string();  // permissions are not all: a disk may be read-only
  if (!mkdtemp(probe.data())) refuse_writing(above);
  fs::remove(probe);
}

// By its description; none where that is no mould's.
std::set<std::string> files_of_mould(const fs::path& folder) {
  const fs::path description = folder / kDescription;
  if (!fs::exists(description)) return {};
  std::set<std::string> files{kDescription, "instructions.html", "robot.png"};
  const auto mould =
      OrderedJson::parse(read_regular_file(description.string(), kLargestSettings_bytes), nullptr, false);
  if (!mould.is_object() || !mould.contains("parts") || !mould["parts"].is_array()) return {};
  for (const OrderedJson& part : mould["parts"])
    if (part.is_object() && part.contains("name") && part["name"].is_string())
      for (const char* ending : kPartEndings) files.insert(part["name"].get<std::string>() + ending);
  return files;
}

// An earlier mould goes with its folder, and nothing else does.
void require_replaceable(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is no folder");
  const std::set<std::string> replaced = files_of_mould(folder);
  for (const auto& file : fs::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    if (replaced.count(name) == 0 || file.is_directory())
      throw std::runtime_error(folder.string() + ": holds other files than a mould, as " + name +
                               "; nothing was written");
    if (is_kept(file.path().string()))
      throw std::runtime_error(file.path().string() + ": would be replaced, though it was read; nothing was written");
  }
}

// The old folder goes only once the new one is in its place.
void put_in_place(const fs::path& made, const fs::path& folder) {
  const fs::path old = made.string() + ".old";
  const bool replaces = fs::exists(folder);
  if (replaces) fs::rename(folder, old);
  fs::rename(made, folder);
  if (replaces) fs::remove_all(old);
}

void write_files(const Mould& mould, const std::string& robot_name, const std::string& folder) {
  for (const MouldPart& part : mould.parts) {
    write_file(folder + "/" + part.name + ".stl", binary_stl(part.surface, "soft_robot_lab mould, millimetres"));
    write_file(folder + "/" + part.name + ".3mf", three_mf(part.surface, part.name));
    write_file(folder + "/" + part.name + ".step", read_regular_file(part.step_file, kLargestMesh_bytes));
    write_file(folder + "/" + part.name + ".png", picture_png(part.surface, Paint{}));
  }
  write_file(folder + "/robot.png", picture_png(mould.robot, Paint{0.95, 0.72, 0.55}));
  write_file(folder + "/instructions.html", mould_instructions(mould, robot_name));
  write_file(folder + "/" + kDescription, mould_json(mould));
}

// As mkdir would, which lets the umask take from it.
void give_mode_of_folders(const std::string& folder) {
  const mode_t mask = umask(0);
  umask(mask);
  if (chmod(folder.c_str(), 0777 & ~mask) != 0)
    throw fs::filesystem_error(folder, std::error_code(errno, std::generic_category()));
}

void remove_quietly(const std::string& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace

std::string mould_json(const Mould& mould) {
  OrderedJson json;
  json["two_part"] = mould.plan.two_part;
  json["lid"] = mould.plan.lid;
  if (mould.plan.lid) json["first_pour_m3"] = mould.plan.first_pour_m3;
  json["direction"] = triple(mould.plan.direction);
  json["up"] = triple(mould.plan.frame.col(2));
  if (mould.plan.two_part) json["parting_m"] = mould.plan.parting_m;
  for (const MouldPart& part : mould.parts) json["parts"].push_back(part_json(part));
  json["robot_volume_m3"] = mould.robot_volume_m3;
  json["block_volume_m3"] = mould.plan.block_volume_m3;
  json["closure"] = mould.closure;
  json["cavity_distance_m"] = mould.cavity_distance_m;
  json["equation_distance_m"] = mould.equation_distance_m;
  for (const SheathPiece& piece : mould.plan.sheaths)
    json["sheaths"].push_back(
        {{"cable", piece.cable}, {"length_m", piece.length_m()}, {"in_teeth_m", piece.in_teeth_m}});
  json["flash_m3"] = mould.plan.flash_m3;
  json["open_top_m2"] = mould.plan.top_area_m2;
  json["air_holes"] = mould.plan.air_holes.size();
  json["vents"] = mould.plan.vents.size();
  json["sprue"] = mould.plan.sprue.has_value();
  json["bolts"] = mould.plan.bolts;
  json["keys"] = mould.plan.keys;
  json["silicone"] = {{"volume_m3", mould.silicone.volume_m3},
                      {"mass_g", mould.silicone.mass_g},
                      {"part_a_g", mould.silicone.part_a_g},
                      {"part_b_g", mould.silicone.part_b_g}};
  return json.dump(2) + "\n";
}

std::string mould_instructions(const Mould& mould, const std::string& robot_name) {
  std::string list;
  for (const std::string& step : steps_of(mould)) list += "<li>" + step + "</li>\n";
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Casting " + html_escaped(robot_name) +
         "</title></head><body>\n<h1>Casting " + html_escaped(robot_name) + "</h1>\n" + parts_table(mould) + "<ol>\n" +
         list + "</ol>\n" + pictures_html(mould) + "</body></html>\n";
}

void require_mould_folder(const std::string& folder) {
  const fs::path place = place_of(folder);
  require_replaceable(place);
  require_writable(place);
}

void write_mould(const Mould& mould, const std::string& robot_name, const std::string& folder) {
  require_mould_folder(folder);
  const fs::path place = place_of(folder);
  fs::create_directories(place.parent_path());
  std::string made = place.string() + ".XXXXXX";
  if (!mkdtemp(made.data())) refuse_writing(place.parent_path());
  try {
    write_files(mould, robot_name, made);
    give_mode_of_folders(made);
    put_in_place(made, place);
  } catch (const WriteError& error) {
    remove_quietly(made);
    throw WriteError(place.string() + std::string(error.what()).substr(made.size()));
  } catch (...) {
    remove_quietly(made);
    throw;
  }
}

}  // namespace soft_robot_lab
