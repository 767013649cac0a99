#include "cuda/layout/arrangement/row_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

namespace evodevo::cuda {
namespace {

constexpr std::size_t most_rows = 64;  // as many as a 64-bit mask has bits

/// An edge colouring of the bipartite graph whose vertices are lanes and banks and whose edges are springs; the colours
/// are the rows. If no vertex has more edges than there are colours, every edge can get a colour (Koenig), if need be
/// by swapping two colours along an alternating path.
class Colouring {
 public:
  Colouring(std::span<Link> links, std::size_t rows) : links_(links) {
    free_.fill(rows == most_rows ? ~0ull : (1ull << rows) - 1);
    for (auto& of_vertex : edge_) std::fill_n(of_vertex.begin(), rows, -1);
  }

  /// Leaves link `i` in its row; false if its lane or its bank already has a spring in that row.
  bool keep(int i) {
    const Link& link = links_[i];
    const bool fits = (free_[link.lane] & free_[32 + link.bank]) >> link.row & 1;
    if (fits) set(i, link.row);
    return fits;
  }

  /// Gives link `i` a row in which neither its lane nor its bank has a spring; false if one of them has no free row.
  bool assign(int i) {
    const int lane = links_[i].lane, bank = 32 + links_[i].bank;
    if (free_[lane] == 0 || free_[bank] == 0) return false;
    std::uint64_t common = free_[lane] & free_[bank];
    if (common == 0) {
      const int row = std::countr_zero(free_[lane]);
      swap_along_path(bank, row, std::countr_zero(free_[bank]));
      common = 1ull << row;
    }
    set(i, static_cast<std::uint32_t>(std::countr_zero(common)));
    return true;
  }

  /// Gives link `i` a free row of its lane in spite of a bank conflict: the row where the conflict costs least.
  void squeeze(int i) {
    int best = 0, best_cost = 1 << 30;
    for (std::uint64_t free = free_[links_[i].lane]; free != 0; free &= free - 1) {
      const int row = std::countr_zero(free);
      const int cost = row_cost(row, links_[i].bank);
      if (cost < best_cost) best = row, best_cost = cost;
    }
    links_[i].row = static_cast<std::uint32_t>(best);
    free_[links_[i].lane] &= ~(1ull << best);
    ++extra_[best][links_[i].bank];
  }

 private:
  /// The vertex at the other end of an edge.
  int across(int edge, int vertex) const { return vertex < 32 ? 32 + links_[edge].bank : links_[edge].lane; }

  void set(int edge, std::uint32_t row) {
    links_[edge].row = row;
    for (const int vertex : {static_cast<int>(links_[edge].lane), 32 + links_[edge].bank}) {
      edge_[vertex][row] = edge;
      free_[vertex] &= ~(1ull << row);
    }
  }

  /// Swaps the rows `taken` and `open` along the path that leaves `vertex` in row `taken`, so that `vertex` has that
  /// row free.
  void swap_along_path(int vertex, int taken, int open) {
    path_.clear();
    for (int at = vertex, row = taken; edge_[at][row] >= 0; row = taken + open - row) {
      const int edge = edge_[at][row];
      path_.push_back(edge);
      at = across(edge, at);
    }
    for (const int edge : path_)
      for (const int at : {static_cast<int>(links_[edge].lane), 32 + links_[edge].bank}) {
        edge_[at][links_[edge].row] = -1;
        free_[at] |= 1ull << links_[edge].row;
      }
    for (const int edge : path_) set(edge, static_cast<std::uint32_t>(taken + open) - links_[edge].row);
  }

  /// The cost of one more spring of `bank` in `row`: mainly the number of additional wavefronts that an access takes;
  /// among rows for which this number is equal, the number of springs of the bank that are already in the row.
  int row_cost(int row, int bank) const {
    int most = 0;
    for (int other = 0; other < 32; ++other) most = std::max(most, in_bank(row, other));
    return 64 * std::max(0, in_bank(row, bank) + 1 - most) + in_bank(row, bank);
  }
  int in_bank(int row, int bank) const { return (edge_[32 + bank][row] >= 0) + extra_[row][bank]; }

  std::span<Link> links_;
  std::array<std::uint64_t, 64> free_;                           // free rows as bits, by lane and 32 + bank
  std::array<std::array<std::int32_t, most_rows>, 64> edge_;     // index of the link, by vertex and row; -1: none
  std::array<std::array<std::uint8_t, 32>, most_rows> extra_{};  // springs squeezed in, by row and bank
  std::vector<int> path_;
};

}  // namespace

void choose_rows(std::span<Link> links, std::size_t rows) {
  if (rows > most_rows) {  // that many springs at one mass are rare: bank conflicts are accepted
    std::array<std::uint32_t, 32> next{};
    for (Link& link : links) link.row = next[link.lane]++;
    return;
  }
  Colouring colouring(links, rows);
  std::vector<int> unplaced, left;
  for (int i = 0; i < static_cast<int>(links.size()); ++i)
    if (links[i].row >= rows || !colouring.keep(i)) unplaced.push_back(i);
  for (const int i : unplaced)
    if (!colouring.assign(i)) left.push_back(i);
  for (const int i : left) colouring.squeeze(i);
}

}  // namespace evodevo::cuda
