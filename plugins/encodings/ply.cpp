// PLY files: a header that describes elements, each with a number of items, and then the values of all items as text or
// in binary.
#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "shape.hpp"

namespace evodevo {
namespace {

template <class Number>
double from_bytes(const char* bytes, bool reversed) {
  std::array<char, sizeof(Number)> own;
  std::copy_n(bytes, own.size(), own.begin());
  if (reversed) std::reverse(own.begin(), own.end());
  return static_cast<double>(std::bit_cast<Number>(own));
}

/// A type of numbers, with its names in old and new files.
struct Type {
  std::string_view name, new_name;
  std::size_t size;
  double (*from_bytes)(const char* bytes, bool reversed);
};

constexpr std::array<Type, 8> types = {{{"char", "int8", 1, from_bytes<std::int8_t>},
                                        {"uchar", "uint8", 1, from_bytes<std::uint8_t>},
                                        {"short", "int16", 2, from_bytes<std::int16_t>},
                                        {"ushort", "uint16", 2, from_bytes<std::uint16_t>},
                                        {"int", "int32", 4, from_bytes<std::int32_t>},
                                        {"uint", "uint32", 4, from_bytes<std::uint32_t>},
                                        {"float", "float32", 4, from_bytes<float>},
                                        {"double", "float64", 8, from_bytes<double>}}};

/// A number of each item, or a list of numbers.
struct Property {
  std::string_view name;
  const Type* type;
  const Type* length = nullptr;  ///< type of the list's length; nullptr: not a list
};

struct Element {
  std::string_view name;
  std::uint64_t count;  ///< as the header says, which may be more than the file has
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(std::string_view content) : rest_(content) {}

  Shape read() {
    read_header();
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;  // such items take no bytes, so the file would never end
      for (std::uint64_t item = 0; item < element.count; ++item) {
        place_ = {&element, item};
        read_item(element);
      }
    }
    return std::move(shape_);
  }

 private:
  [[noreturn]] static void fail_in_header(std::string_view line, const std::string& expected) {
    throw std::invalid_argument("header line \"" + std::string(line.substr(0, 80)) + "\"; expected " + expected);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument("element " + std::string(place_.element->name) + ", item " +
                                std::to_string(place_.item + 1) + " of " + std::to_string(place_.element->count) +
                                ": " + what);
  }

  void read_header() {
    next_line(rest_);  // "ply"
    for (;;) {
      if (rest_.empty()) throw std::invalid_argument("the header has no end; expected a line end_header");
      const std::string_view line = next_line(rest_);
      std::string_view words = line;
      const std::string_view what = next_word(words);
      if (what == "end_header") break;
      if (what == "format") read_format(line, next_word(words));
      if (what == "element") read_element(line, words);
      if (what == "property") read_property(line, words);
    }
    if (format_.empty()) throw std::invalid_argument("the header has no line format; expected one");
    check_elements();
  }

  void read_format(std::string_view line, std::string_view format) {
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
      fail_in_header(line, "ascii, binary_little_endian or binary_big_endian");
    format_ = format;
    constexpr bool little = std::endian::native == std::endian::little;
    reversed_ = (format == "binary_big_endian") == little;
  }

  void read_element(std::string_view line, std::string_view words) {
    const std::string_view name = next_word(words);
    const auto count = number_in<std::uint64_t>(next_word(words));
    if (!count) fail_in_header(line, "a name and a whole number of items");
    elements_.push_back({name, *count, {}});
  }

  void read_property(std::string_view line, std::string_view words) {
    const std::string_view first = next_word(words);
    const bool is_list = first == "list";
    const Type* length = is_list ? type_named(next_word(words)) : nullptr;
    const Type* type = type_named(is_list ? next_word(words) : first);
    const std::string_view name = next_word(words);
    if (type == nullptr || (is_list && length == nullptr) || name.empty() || elements_.empty())
      fail_in_header(line, "known types and a name, after an element");
    elements_.back().properties.push_back({name, type, length});
  }

  static const Type* type_named(std::string_view name) {
    const auto type =
        std::find_if(types.begin(), types.end(), [&](const Type& t) { return t.name == name || t.new_name == name; });
    return type == types.end() ? nullptr : &*type;
  }

  static bool is_corners(const Property& property) {
    return property.length != nullptr && (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void check_elements() const {
    for (const Element& element : elements_) {
      const auto has = [&](const auto& is_it) {
        return std::any_of(element.properties.begin(), element.properties.end(), is_it);
      };
      for (const std::string_view axis : axes)
        if (element.name == "vertex" && !has([&](const Property& p) { return p.name == axis && p.length == nullptr; }))
          throw std::invalid_argument("element vertex has no property " + std::string(axis) + "; expected x, y and z");
      if (element.name == "face" && !has(is_corners))
        throw std::invalid_argument("element face has no list vertex_indices; expected one");
    }
  }

  void read_item(const Element& element) {
    std::array<double, 3> place{};
    for (const Property& property : element.properties) {
      if (property.length != nullptr) {
        read_list(property, element.name == "face" && is_corners(property));
        continue;
      }
      const double number = read_number(*property.type);
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (property.name == axes[axis]) place[axis] = number;
    }
    if (element.name == "vertex") shape_.points.push_back({place[0], place[1], place[2]});
  }

  void read_list(const Property& property, bool is_face) {
    const double length = read_number(*property.length);
    if (!is_index(length)) fail("a list has no whole number of items; expected one from 0");
    std::vector<std::int64_t> corners;
    for (double i = 0; i < length; ++i) {
      const double number = read_number(*property.type);
      if (!is_face) continue;
      if (!is_index(number)) fail("no index of a vertex; expected a whole number from 0");
      corners.push_back(static_cast<std::int64_t>(number));
    }
    if (!is_face) return;
    try {
      shape_.add_polygon(corners);
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
  }

  static bool is_index(double number) { return number >= 0 && number < 0x1p32 && number == std::floor(number); }

  double read_number(const Type& type) {
    if (format_ == "ascii") {
      const std::string_view word = next_word(rest_);
      if (word.empty()) fail("the file ends here; expected further numbers");
      const auto number = number_in<double>(word);
      if (!number) fail("no number; expected one");
      return *number;
    }
    if (rest_.size() < type.size) fail("the file ends here; expected further numbers");
    const double number = type.from_bytes(rest_.data(), reversed_);
    rest_.remove_prefix(type.size);
    return number;
  }

  static constexpr std::array<std::string_view, 3> axes = {"x", "y", "z"};

  struct Place {
    const Element* element = nullptr;
    std::uint64_t item = 0;
  };

  std::string_view rest_;  ///< the part of the file that has not been read
  std::string_view format_;
  bool reversed_ = false;  ///< whether the order of bytes is not that of this machine
  std::vector<Element> elements_;
  Place place_;
  Shape shape_;
};

}  // namespace

Shape read_ply(std::string_view content) { return PlyReader(content).read(); }

}  // namespace evodevo
