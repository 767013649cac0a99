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
constexpr std::size_t most_left_out = 12;

/// Numbers masses and springs through a life, in which a body's own numbers change with every edit. Masses that stay
/// keep their order and rest places, and springs are the pairs that they join.
class Census {
 public:
  void add(const Body& body) {
    count_masses(body);
    std::vector<std::uint32_t> springs;
    for (const Spring& spring : body.springs) {
      const auto pair = std::minmax(masses_.back()[spring.a], masses_.back()[spring.b]);
      const auto [found, is_new] = numbers_.try_emplace(pair, static_cast<std::uint32_t>(numbers_.size()));
      if (is_new) {
        ends_.push_back(pair.first);
        ends_.push_back(pair.second);
      }
      springs.push_back(found->second);
    }
    springs_.push_back(std::move(springs));
  }

  std::uint32_t mass_count() const { return mass_count_; }
  const std::vector<std::int64_t>& ends() const { return ends_; }
  const std::vector<std::uint32_t>& masses(std::size_t shot) const { return masses_[shot]; }
  const std::vector<std::uint32_t>& springs(std::size_t shot) const { return springs_[shot]; }

 private:
  void count_masses(const Body& body) {
    std::vector<std::uint32_t> numbers;
    std::size_t old = 0;
    for (const Mass& mass : body.masses) {
      std::size_t match = old;
      while (match < last_.size() && !(last_[match].rest == mass.rest)) ++match;
      numbers.push_back(match < last_.size() ? masses_.back()[match] : mass_count_++);
      if (match < last_.size()) old = match + 1;
    }
    masses_.push_back(std::move(numbers));
    last_ = body.masses;
  }

  std::vector<Mass> last_;
  std::uint32_t mass_count_ = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers_;
  std::vector<std::int64_t> ends_;
  std::vector<std::vector<std::uint32_t>> masses_, springs_;
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

/// The places of all shots, each packed.
std::vector<std::string> packed_shots(const Film& film, std::size_t every, double step) {
  std::vector<std::string> texts;
  for (const Shot& shot : film) texts.push_back(packed_places(kept_frames(shot, every), step));
  return texts;
}

std::size_t size_of(const std::vector<std::string>& texts) {
  std::size_t size = 0;
  for (const std::string& text : texts) size += text.size();
  return size;
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

/// The mass' materials by their number in the census; -1 where a mass has none.
std::string packed_mass_materials(const Film& film, const Census& census) {
  std::vector<std::int64_t> materials(census.mass_count(), no_material);
  for (std::size_t s = 0; s < film.size(); ++s)
    for (std::size_t i = 0; i < film[s].body.masses.size(); ++i)
      materials[census.masses(s)[i]] = film[s].body.masses[i].material;
  return packed(materials);
}

std::vector<double> times(const Shot& shot, std::size_t every) {
  std::vector<double> times;
  for (const Frame* frame : kept_frames(shot, every)) times.push_back(std::round(1e6 * frame->time) / 1e6);
  return times;
}

}  // namespace

Json film_json(const Film& filmed, const std::vector<std::string>& names, std::size_t budget) {
  Film film;
  for (const Shot& shot : filmed)
    if (!shot.frames.empty()) film.push_back(shot);
  if (film.empty()) return {{"shots", Json::array()}};
  Census census;
  for (const Shot& shot : film) census.add(shot.body);

  const double side = longest_side(film.front().frames.front());
  const double step = (side > 0 ? side : 1) / parts_of_length;
  std::size_t every = least_left_out;
  std::vector<std::string> places = packed_shots(film, every, step);
  while (size_of(places) > budget && every < most_left_out) places = packed_shots(film, ++every, step);
  ErrorSum errors;
  for (const Shot& shot : film) errors.add(shot, every, step);
  const ViewError error = errors.error();

  const double most = most_stress(film);
  Json shots = Json::array();
  for (std::size_t s = 0; s < film.size(); ++s)
    shots.push_back({{"name", names.at(s)},
                     {"times", times(film[s], every)},
                     {"masses", packed_differences(census.masses(s))},
                     {"springs", packed_differences(census.springs(s))},
                     {"materials", packed_materials(film[s].body)},
                     {"stress", packed_stress(film[s], most)},
                     {"places", places[s]}});
  return {{"masses", census.mass_count()},
          {"mass_materials", packed_mass_materials(film, census)},
          {"ends", packed(census.ends())},
          {"materials", materials_json(film.back().body)},
          {"most_stress", most},
          {"step", step},
          {"every", every},
          {"error", {{"largest", error.largest}, {"most", error.most}}},
          {"shots", std::move(shots)}};
}

}  // namespace evodevo
