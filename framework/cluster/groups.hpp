// The ranks of a run with islands, divided into groups.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "cluster/channel.hpp"

namespace evodevo {

/// Divides ranks among islands. If there are at least as many ranks as islands, each island has a group of ranks;
/// otherwise each rank is a group of its own and has one or several islands. The first rank of a group breeds, selects
/// and writes; the others evaluate for it.
class Groups {
 public:
  Groups(int ranks, std::int64_t islands) : ranks_(ranks), islands_(islands) {}

  int count() const { return static_cast<int>(std::min<std::int64_t>(ranks_, islands_)); }
  int of_rank(int rank) const { return static_cast<int>(std::int64_t{rank} * count() / ranks_); }
  /// Islands are numbered from 1.
  int of_island(std::int64_t island) const { return static_cast<int>((island - 1) * count() / islands_); }
  /// The ranks of a group in ascending order, at least one.
  std::vector<int> ranks(int group) const;
  /// The numbers of the islands of a group in ascending order, at least one.
  std::vector<std::int64_t> islands(int group) const;
  int first_rank(int group) const { return ranks(group).front(); }

 private:
  int ranks_;
  std::int64_t islands_;
};

/// Joins the ranks of one group, numbered from 0 within it, over the channel of all ranks. A rank that is not the first
/// of its group hears the first one of its group and the first one of all, and takes both for rank 0.
class GroupChannel : public Channel {
 public:
  /// `ranks` are those of the group, among which is that of `all`, which must outlive this object.
  GroupChannel(Channel& all, std::vector<int> ranks);

  int rank() const override { return number_of(all_.rank()); }
  int size() const override { return static_cast<int>(ranks_.size()); }
  int number_in_run(int rank) const override { return ranks_.at(static_cast<std::size_t>(rank)); }
  int rank_on_host() const override { return all_.rank_on_host(); }
  int ranks_on_host() const override { return all_.ranks_on_host(); }
  void send(int to, std::string bytes) override {
    all_.send(ranks_.at(static_cast<std::size_t>(to)), std::move(bytes));
  }
  std::optional<Received> receive() override;
  /// On a rank that is not the first of its group, takes a number among all ranks, as End of the first one of all
  /// names them.
  void give_up(int lost) override { all_.give_up(rank() == 0 ? ranks_.at(static_cast<std::size_t>(lost)) : lost); }
  std::vector<int> given_up() const override;
  /// Does nothing: the ranks leave the channel of all ranks.
  void leave() override {}

  bool has(int rank_of_all) const { return std::ranges::find(ranks_, rank_of_all) != ranks_.end(); }
  /// The number within the group of a rank of all; 0 for ranks of other groups.
  int number_of(int rank_of_all) const;

 private:
  Channel& all_;
  std::vector<int> ranks_;
};

}  // namespace evodevo
