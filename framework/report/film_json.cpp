#include "report/film_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/materials.hpp"
#include "report/packing.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t least_thinning = 2;  ///< at most every second frame is kept, because 30 frames/s look smooth
constexpr std::size_t measured_finer = 4;  ///< ratio of the frame rate of measured shots to that of others
constexpr double rests_finer = 8;  ///< ratio of the units of positions and rest lengths: forces depend on differences

/// A level of detail: the precision of numbers, and how many frames may be left out at this precision.
struct Detail {
  double parts_of_length;     ///< the unit of positions is the body's longest side divided by this
  int stress_levels;          ///< number of levels of sqrt(stress); many springs bear little stress, and few much
  std::size_t most_thinning;  ///< keep only every n-th filmed frame, with n up to this, before reducing precision
};

// With 2048 units per body length, errors are smaller than the pixels of a page. If every 16th of 60 frames per second
// is kept, a muscle's period of one second has about four frames.
constexpr Detail details[] = {{8192, 255, 4}, {2048, 63, 16}, {1024, 15, std::numeric_limits<std::size_t>::max()}};

/// Assigns numbers to springs by the masses that they join and, if springs act in parallel, by their order among those
/// of the same two masses. A spring keeps its number throughout the film, unless one that is parallel to it and before
/// it is removed.
class SpringNumbers {
 public:
  /// The springs of a shot.
  struct Present {
    std::vector<std::uint32_t> numbers;  ///< their numbers in the film, ascending
    std::vector<std::size_t> indices;    ///< their indices in the body, in the same order
  };

  explicit SpringNumbers(const Film& film) {
    for (const Shot& shot : film) shots_.push_back(present(shot));
  }

  const Present& in(std::size_t shot) const { return shots_[shot]; }
  const std::vector<std::int64_t>& ends() const { return ends_; }
  std::size_t count() const { return numbers_.size(); }

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  // of masses

  Present present(const Shot& shot) {
    std::vector<std::pair<std::uint32_t, std::size_t>> springs;
    std::map<Pair, std::uint32_t> parallel;  // the springs so far that join two masses
    for (const Spring& spring : shot.body.springs) {
      const Pair pair = std::minmax(shot.numbers.at(spring.a), shot.numbers.at(spring.b));
      springs.emplace_back(number(pair, parallel[pair]++), springs.size());
    }
    std::ranges::sort(springs);
    Present present;
    for (const auto& [number, index] : springs) {
      present.numbers.push_back(number);
      present.indices.push_back(index);
    }
    return present;
  }

  std::uint32_t number(const Pair& pair, std::uint32_t order) {
    const auto next = static_cast<std::uint32_t>(numbers_.size());
    const auto [found, is_new] = numbers_.try_emplace({pair, order}, next);
    if (is_new) ends_.insert(ends_.end(), {pair.first, pair.second});
    return found->second;
  }

  std::map<std::pair<Pair, std::uint32_t>, std::uint32_t> numbers_;
  std::vector<std::int64_t> ends_;
  std::vector<Present> shots_;
};

double on_grid(double value, double step) { return step * static_cast<double>(whole_steps(value, step)); }

/// Collects the errors of positions that are interpolated linearly between the kept frames, over all filmed frames.
class ErrorSum {
 public:
  void add(const Shot& shot, const std::vector<const Frame*>& kept, double step) {
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
    return {.largest = *std::max_element(most, distances_.end()), .most = *most};
  }

 private:
  void add(const Frame& frame, const Frame& before, const Frame& after, double part, double step) {
    for (std::size_t i = 0; i < frame.positions.size(); ++i) {
      double square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double shown =
            (1 - part) * on_grid(before.positions[i][axis], step) + part * on_grid(after.positions[i][axis], step);
        square += (shown - frame.positions[i][axis]) * (shown - frame.positions[i][axis]);
      }
      distances_.push_back(static_cast<float>(std::sqrt(square)));
    }
  }

  std::vector<float> distances_;
};

/// Returns the longest side of the body at birth, m, or 1 if it is zero.
double body_size(const Film& film) {
  std::vector<Vec3> positions;
  for (const SeenPlace& p : film.front().frames.front().positions) positions.push_back({p[0], p[1], p[2]});
  const double side = bounding_box(positions).longest_side();
  return side > 0 ? side : 1;
}

std::uint32_t mass_count(const Film& film) {
  std::uint32_t count = 0;
  for (const Shot& shot : film)
    if (!shot.numbers.empty()) count = std::max(count, shot.numbers.back() + 1);
  return count;
}

double most_stress(const Film& film) {
  double most = 0;
  for (const Shot& shot : film)
    for (const double stress : shot.stress) most = std::max(most, stress);
  return most;
}

/// The materials of all masses and springs of a film, those of the experiment first. A spring whose stiffness differs
/// from that of its material has a material of its own here, with a stiffness in steps of 2^(1/16), which are too small
/// for the eye.
class FilmMaterials {
 public:
  explicit FilmMaterials(const Film& film) : materials_(base_materials(film.front().body)) {
    MaterialList list(materials_);
    for (const Shot& shot : film) {
      Positions& positions = positions_.emplace_back();
      for (const Material& material : shot.body.materials) positions.of_materials.push_back(list.index(material));
      for (const Spring& spring : shot.body.springs)
        positions.of_springs.push_back(list.index(seen(shot.body, spring)));
    }
  }

  /// Returns the film's index of a material in the body of a shot.
  std::int64_t of_material(std::size_t shot, std::size_t material) const {
    return positions_[shot].of_materials[material];
  }

  /// Returns the film's index of the material of a spring in the body of a shot.
  std::int64_t of_spring(std::size_t shot, std::size_t spring) const { return positions_[shot].of_springs[spring]; }

  Json json() const {
    Json materials = Json::array();
    for (const Material& m : materials_)
      materials.push_back({{"stiffness", m.stiffness},
                           {"amplitude", m.amplitude},
                           {"frequency", m.frequency},
                           {"phase", m.phase},
                           {"damping", m.damping}});
    return materials;
  }

 private:
  struct Positions {  // indices in the film
    std::vector<std::int64_t> of_materials, of_springs;
  };

  static Material seen(const Body& body, const Spring& spring) {
    Material material = body.materials[spring.material];
    if (spring.stiffness_factor != 1)
      material.stiffness *= std::exp2(std::round(16 * std::log2(spring.stiffness_factor)) / 16);
    return material;
  }

  static std::vector<Material> base_materials(const Body& body) {
    return {body.materials.begin(), body.materials.begin() + body.base_materials};
  }

  std::vector<Material> materials_;
  std::vector<Positions> positions_;  ///< by shot
};

/// Returns the materials of all masses, in the order of their numbers; -1 for a mass without a material.
std::string packed_mass_materials(const Film& film, const FilmMaterials& materials) {
  std::vector<std::int64_t> of_masses(mass_count(film), no_material);
  for (std::size_t s = 0; s < film.size(); ++s)
    for (std::size_t i = 0; i < film[s].numbers.size(); ++i)
      if (const std::int32_t material = film[s].body.masses[i].material; material != no_material)
        of_masses[film[s].numbers[i]] = materials.of_material(s, static_cast<std::size_t>(material));
  return packed(of_masses);
}

std::vector<double> times(const std::vector<const Frame*>& frames) {
  std::vector<double> times;
  for (const Frame* frame : frames) times.push_back(std::round(1e6 * frame->time) / 1e6);
  return times;
}

/// The moving part of a film.
struct Motion {
  Json shots;             ///< times and positions of each shot
  double step = 0;        ///< unit of positions, m
  std::size_t every = 0;  ///< n, if every n-th filmed frame is kept
  bool fits = false;      ///< whether it fits into the budget
};

class FilmWriter {
 public:
  FilmWriter(const Film& film, const std::vector<Title>& titles)
      : film_(film),
        titles_(titles),
        springs_(film),
        materials_(film),
        size_(body_size(film)),
        most_stress_(most_stress(film)) {}

  /// Returns the JSON of the film without times and positions.
  Json still(const Detail& detail) const {
    return {{"masses", mass_count(film_)},     {"mass_materials", packed_mass_materials(film_, materials_)},
            {"ends", packed(springs_.ends())}, {"materials", materials_.json()},
            {"most_stress", most_stress_},     {"stress_levels", detail.stress_levels},
            {"rest_step", rest_step(detail)},  {"shots", shots_json(detail)}};
  }

  /// Returns the motion. Leaves out only as many frames as necessary to fit into `budget` bytes, and no more than
  /// `detail` allows.
  Motion motion(const Detail& detail, std::size_t budget) const {
    std::size_t most = least_thinning;
    for (const Shot& shot : film_) most = std::max(most, std::min(shot.frames.size(), detail.most_thinning));
    Motion motion{.step = step(detail), .every = least_thinning};
    for (;;) {
      motion.shots = motion_json(motion);
      const std::size_t size = motion.shots.dump().size();
      motion.fits = size <= budget;
      if (motion.fits || motion.every >= most) return motion;
      // Frames that are further apart usually take more bits each, so this does not leave out more than necessary.
      motion.every = budget == 0 ? most : std::clamp(motion.every * size / budget, motion.every + 1, most);
    }
  }

  /// Merges the motion into the rest of the film's JSON, and adds the ViewError.
  Json whole(Json still, const Motion& motion) const {
    ErrorSum errors;
    for (std::size_t i = 0; i < film_.size(); ++i) {
      errors.add(film_[i], kept_frames(i, motion.every), motion.step);
      still["shots"][i].update(motion.shots[i]);
    }
    const ViewError error = errors.error();
    // half the distance between the two highest levels, which are furthest apart
    const double stress = most_stress_ / still["stress_levels"].get<double>();
    still["step"] = motion.step;
    still["error"] = {{"largest", error.largest}, {"most", error.most}, {"stress", stress}};
    return still;
  }

 private:
  /// The unit of positions, m.
  double step(const Detail& detail) const { return size_ / detail.parts_of_length; }
  double rest_step(const Detail& detail) const { return step(detail) / rests_finer; }

  /// Returns, for each shot, the masses and springs that are present, and the springs' materials, rest lengths and
  /// stress.
  Json shots_json(const Detail& detail) const {
    ValuePacking materials(springs_.count()), rests(springs_.count()), stress(springs_.count());
    std::vector<std::uint32_t> masses_before, springs_before;
    Json shots = Json::array();
    for (std::size_t i = 0; i < film_.size(); ++i) {
      const auto& [numbers, indices] = springs_.in(i);
      shots.push_back({{"name", titles_.at(i).name},
                       {"masses", packed_changes(masses_before, film_[i].numbers)},
                       {"springs", packed_changes(springs_before, numbers)},
                       {"materials", materials.next(numbers, materials_of(i, indices))},
                       {"rest_lengths", rests.next(numbers, rests_of(film_[i], indices, rest_step(detail)))},
                       {"stress", stress.next(numbers, stress_of(film_[i], indices, detail.stress_levels))}});
      masses_before = film_[i].numbers;
      springs_before = numbers;
    }
    return shots;
  }

  std::vector<std::int64_t> materials_of(std::size_t shot, std::span<const std::size_t> springs) const {
    std::vector<std::int64_t> materials;
    for (const std::size_t s : springs) materials.push_back(materials_.of_spring(shot, s));
    return materials;
  }

  static std::vector<std::int64_t> rests_of(const Shot& shot, std::span<const std::size_t> springs, double unit) {
    std::vector<std::int64_t> rests;
    for (const std::size_t s : springs) rests.push_back(std::llround(shot.body.springs[s].rest_length / unit));
    return rests;
  }

  std::vector<std::int64_t> stress_of(const Shot& shot, std::span<const std::size_t> springs, int levels) const {
    std::vector<std::int64_t> stress;
    if (shot.stress.empty()) return stress;
    for (const std::size_t s : springs)
      stress.push_back(most_stress_ > 0 ? std::lround(levels * std::sqrt(shot.stress[s] / most_stress_)) : 0);
    return stress;
  }

  Json motion_json(const Motion& motion) const {
    PlacePacking positions(mass_count(film_), motion.step);
    Json shots = Json::array();
    for (std::size_t i = 0; i < film_.size(); ++i) {
      const std::vector<const Frame*> kept = kept_frames(i, motion.every);
      shots.push_back({{"times", times(kept)}, {"positions", positions.next(kept, film_[i].numbers)}});
    }
    return shots;
  }

  /// Returns every n-th frame of the i-th shot, with n = `every`, and the last frame. If the shot is measured, returns
  /// more frames.
  std::vector<const Frame*> kept_frames(std::size_t i, std::size_t every) const {
    const std::vector<Frame>& frames = film_[i].frames;
    if (titles_.at(i).measured && every < frames.size()) every = std::max(least_thinning, every / measured_finer);
    std::vector<const Frame*> kept;
    for (std::size_t f = 0; f < frames.size(); ++f)
      if (f % every == 0 || f + 1 == frames.size()) kept.push_back(&frames[f]);
    return kept;
  }

  const Film& film_;
  const std::vector<Title>& titles_;
  SpringNumbers springs_;
  FilmMaterials materials_;
  double size_;         ///< longest side of the body at birth, m
  double most_stress_;  ///< largest stress in the film, N
};

}  // namespace

Json film_json(const Film& film, const std::vector<Title>& titles, std::size_t budget) {
  if (film.empty()) return {{"shots", Json::array()}};
  const FilmWriter writer(film, titles);
  Json still;
  Motion motion;
  for (const Detail& detail : details) {
    still = writer.still(detail);
    motion = writer.motion(detail, budget - std::min(budget, still.dump().size()));
    if (motion.fits) break;
  }
  return writer.whole(std::move(still), motion);
}

}  // namespace evodevo
