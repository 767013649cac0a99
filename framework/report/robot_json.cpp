#include "report/robot_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "report/packing.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr double parts_of_length = 8192;   ///< places are whole multiples of so small a part of the body's longest side
constexpr std::size_t least_left_out = 2;  ///< 30 frames a second look smooth

/// Numbers springs through a film, by the masses that they join.
class SpringNumbers {
 public:
  std::vector<std::uint32_t> of(const Shot& shot) {
    std::vector<std::uint32_t> numbers;
    for (const Spring& spring : shot.body.springs) {
      const auto pair = std::minmax(shot.numbers.at(spring.a), shot.numbers.at(spring.b));
      const auto [found, is_new] = numbers_.try_emplace(pair, static_cast<std::uint32_t>(numbers_.size()));
      if (is_new) ends_.insert(ends_.end(), {pair.first, pair.second});
      numbers.push_back(found->second);
    }
    return numbers;
  }

  const std::vector<std::int64_t>& ends() const { return ends_; }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers_;
  std::vector<std::int64_t> ends_;
};

std::vector<const Frame*> kept_frames(const Shot& shot, std::size_t every) {
  std::vector<const Frame*> kept;
  for (std::size_t i = 0; i < shot.frames.size(); ++i)
    if (i % every == 0 || i + 1 == shot.frames.size()) kept.push_back(&shot.frames[i]);
  return kept;
}

double on_grid(double value, double step) { return step * static_cast<double>(std::llround(value / step)); }

/// Adds up how far straight lines between the frames kept are from all frames.
class ErrorSum {
 public:
  void add(const Shot& shot, std::size_t every, double step) {
    const std::vector<const Frame*> kept = kept_frames(shot, every);
    std::size_t next = 0;
    for (const Frame& frame : shot.frames) {
      while (next < kept.size() && kept[next]->time < frame.time) ++next;
      const Frame &after = *kept[next], &before = *kept[next == 0 ? 0 : next - 1];
      const double span = after.time - before.time;
      add(frame, before, after, span > 0 ? (frame.time - before.time) / span : 1, step);
    }
  }

  ViewError error() {
    if (distances_.empty()) return {};
    const auto most = distances_.begin() + static_cast<std::ptrdiff_t>(distances_.size() * 99 / 100);
    std::nth_element(distances_.begin(), most, distances_.end());
    return {*std::max_element(most, distances_.end()), *most};
  }

 private:
  void add(const Frame& frame, const Frame& before, const Frame& after, double part, double step) {
    for (std::size_t i = 0; i < frame.places.size(); ++i) {
      double square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double shown =
            (1 - part) * on_grid(before.places[i][axis], step) + part * on_grid(after.places[i][axis], step);
        square += (shown - frame.places[i][axis]) * (shown - frame.places[i][axis]);
      }
      distances_.push_back(static_cast<float>(std::sqrt(square)));
    }
  }

  std::vector<float> distances_;
};

double longest_side(const Frame& frame) {
  std::vector<Vec3> places;
  for (const SeenPlace& p : frame.places) places.push_back({p[0], p[1], p[2]});
  return bounding_box(places).longest_side();
}

std::uint32_t mass_count(const Film& film) {
  std::uint32_t count = 0;
  for (const Shot& shot : film)
    if (!shot.numbers.empty()) count = std::max(count, shot.numbers.back() + 1);
  return count;
}

std::string packed_materials(const Body& body) {
  std::vector<std::int64_t> materials;
  for (const Spring& spring : body.springs) materials.push_back(spring.material);
  return packed(materials);
}

/// In 255 parts of the root of the most, since few springs bear much and many little.
std::string packed_stress(const Shot& shot, double most) {
  std::vector<std::int64_t> levels;
  for (const double stress : shot.stress) levels.push_back(most > 0 ? std::lround(255 * std::sqrt(stress / most)) : 0);
  return packed(levels);
}

double most_stress(const Film& film) {
  double most = 0;
  for (const Shot& shot : film)
    for (const double stress : shot.stress) most = std::max(most, stress);
  return most;
}

/// The materials that springs of the film have, with what they do.
Json materials_json(const Body& body) {
  Json materials = Json::array();
  for (const Material& m : body.materials)
    materials.push_back(
        {{"stiffness", m.stiffness}, {"amplitude", m.amplitude}, {"frequency", m.frequency}, {"phase", m.phase}});
  return materials;
}

/// The masses' materials by their numbers; -1 where a mass has none.
std::string packed_mass_materials(const Film& film) {
  std::vector<std::int64_t> materials(mass_count(film), no_material);
  for (const Shot& shot : film)
    for (std::size_t i = 0; i < shot.numbers.size(); ++i) materials[shot.numbers[i]] = shot.body.masses[i].material;
  return packed(materials);
}

std::vector<double> times(const std::vector<const Frame*>& frames) {
  std::vector<double> times;
  for (const Frame* frame : frames) times.push_back(std::round(1e6 * frame->time) / 1e6);
  return times;
}

/// When and where the masses of each shot are.
Json motion_json(const Film& film, std::size_t every, double step) {
  Json motion = Json::array();
  for (const Shot& shot : film) {
    const std::vector<const Frame*> kept = kept_frames(shot, every);
    motion.push_back({{"times", times(kept)}, {"places", packed_places(kept, step)}});
  }
  return motion;
}

/// As many frames as `budget` bytes hold, though never fewer than the first and the last of each shot.
struct Decimation {
  std::size_t every = least_left_out;
  Json motion;

  Decimation(const Film& film, double step, std::size_t budget) {
    std::size_t longest = least_left_out;
    for (const Shot& shot : film) longest = std::max(longest, shot.frames.size());
    for (;;) {
      motion = motion_json(film, every, step);
      const std::size_t size = motion.dump().size();
      if (size <= budget || every >= longest) return;
      // what is further apart takes more bits, so this never leaves out too much
      every = budget == 0 ? longest : std::clamp(every * size / budget, every + 1, longest);
    }
  }
};

/// Who is there in each shot, and how hard it works.
Json shots_json(const Film& film, const std::vector<std::string>& names, double most, SpringNumbers& springs) {
  Json shots = Json::array();
  for (std::size_t i = 0; i < film.size(); ++i)
    shots.push_back({{"name", names.at(i)},
                     {"masses", packed_differences(film[i].numbers)},
                     {"springs", packed_differences(springs.of(film[i]))},
                     {"materials", packed_materials(film[i].body)},
                     {"stress", packed_stress(film[i], most)}});
  return shots;
}

}  // namespace

Json film_json(const Film& filmed, const std::vector<std::string>& names, std::size_t budget) {
  Film film;
  for (const Shot& shot : filmed)
    if (!shot.frames.empty()) film.push_back(shot);
  if (film.empty()) return {{"shots", Json::array()}};
  const double side = longest_side(film.front().frames.front());
  const double step = (side > 0 ? side : 1) / parts_of_length;
  const double most = most_stress(film);
  SpringNumbers springs;
  Json shots = shots_json(film, names, most, springs);
  Json json = {{"masses", mass_count(film)},
               {"mass_materials", packed_mass_materials(film)},
               {"ends", packed(springs.ends())},
               {"materials", materials_json(film.back().body)},
               {"most_stress", most},
               {"step", step}};
  const std::size_t taken = json.dump().size() + shots.dump().size();
  const Decimation decimation(film, step, budget - std::min(budget, taken));
  for (std::size_t i = 0; i < film.size(); ++i) shots[i].update(decimation.motion[i]);
  ErrorSum errors;
  for (const Shot& shot : film) errors.add(shot, decimation.every, step);
  const ViewError error = errors.error();
  json["every"] = decimation.every;
  json["error"] = {{"largest", error.largest}, {"most", error.most}};
  json["shots"] = std::move(shots);
  return json;
}

}  // namespace evodevo
