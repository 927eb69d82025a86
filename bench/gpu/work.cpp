// SPDX-License-Identifier: Apache-2.0
#include "bench/gpu/work.hpp"

namespace fathom::bench {
namespace {

class Streamed final : public Work {
 public:
  Streamed(std::unique_ptr<Plan> plan, const Pixels& pixels, const Cell& cell)
      : pixels_(pixels), cell_(cell), windows_(cell.tiles.list()), plan_(std::move(plan)) {
    for (Seat& seat : seats_) {
      seat.scores.resize(windows_.size() * cell.spec.outputs());
    }
  }

  const Frame& frame(int seat) const override { return seats_[seat].frame; }
  std::vector<double> scores(int seat) const override { return seats_[seat].scores; }

 private:
  struct Seat {
    Frame frame;
    std::vector<double> scores;
    Plan::Ticket ticket;
  };

  void do_start(int i) override {
    Seat& seat = seats_[i];
    seat.frame = pixels_.frame(number_++, cell_.tiles, cell_.depth);
    seat.ticket = plan_->submit(seat.frame, windows_, seat.scores);
  }
  void do_finish(int i) override { plan_->wait(seats_[i].ticket); }

  const Pixels& pixels_;
  Cell cell_;
  std::vector<Window> windows_;
  std::array<Seat, 2> seats_;
  std::size_t number_ = 0;
  std::unique_ptr<Plan> plan_;  // last, so that it goes first, and waits for its batches
};

}  // namespace

std::unique_ptr<Work> streamed(std::unique_ptr<Plan> plan, const Pixels& pixels, const Cell& cell) {
  return std::make_unique<Streamed>(std::move(plan), pixels, cell);
}

}  // namespace fathom::bench
