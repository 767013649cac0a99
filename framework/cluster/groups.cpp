#include "cluster/groups.hpp"

namespace evodevo {

std::vector<int> Groups::ranks(int group) const {
  std::vector<int> found;
  for (int rank = 0; rank < ranks_; ++rank)
    if (of_rank(rank) == group) found.push_back(rank);
  return found;
}

std::vector<std::int64_t> Groups::islands(int group) const {
  std::vector<std::int64_t> found;
  for (std::int64_t island = 1; island <= islands_; ++island)
    if (of_island(island) == group) found.push_back(island);
  return found;
}

GroupChannel::GroupChannel(Channel& all, std::vector<int> ranks) : all_(all), ranks_(std::move(ranks)) {}

std::optional<Received> GroupChannel::receive() {
  std::optional<Received> received = all_.receive();
  if (received) received->from = number_of(received->from);
  return received;
}

std::vector<int> GroupChannel::given_up() const {
  std::vector<int> lost;
  for (const int rank : all_.given_up())
    if (has(rank)) lost.push_back(number_of(rank));
  return lost;
}

int GroupChannel::number_of(int rank_of_all) const {
  const auto found = std::ranges::find(ranks_, rank_of_all);
  return found == ranks_.end() ? 0 : static_cast<int>(found - ranks_.begin());
}

}  // namespace evodevo
