// SPDX-License-Identifier: MIT
#include "e2lf/formats/table/table_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "e2lf/base/contract.h"
#include "e2lf/files/elements.h"
#include "e2lf/formats/table/layout.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::table {
namespace {

/// Converts a number to To; returns true if it does not fit.
template <typename From, typename To>
bool convert_one(From value, To& out) {
  if constexpr (std::is_floating_point_v<From>) {
    const auto number = static_cast<double>(value);
    const bool fits = number == std::trunc(number) && number >= static_cast<double>(std::numeric_limits<To>::min()) &&
                      number < std::ldexp(1.0, std::numeric_limits<To>::digits);
    out = fits ? static_cast<To>(number) : To{};
    return !fits;
  } else {
    out = static_cast<To>(value);
    return (value < From{0} && std::is_unsigned_v<To>) ||
           (static_cast<uint64_t>(value) > static_cast<uint64_t>(std::numeric_limits<To>::max()) && value > From{0});
  }
}

/// Converts a time to microseconds; returns true if it is invalid.
template <typename From>
bool convert_time(From value, TimeUnit unit, int64_t& out) {
  if constexpr (std::is_floating_point_v<From>) {
    const double us = static_cast<double>(value) * us_per(unit);
    const bool fits = std::fabs(us) <= static_cast<double>(kTimeLimitUs);
    out = fits ? static_cast<int64_t>(std::llround(us)) : 0;
    return !fits;
  } else {
    if (convert_one(value, out)) return true;
    if (unit == TimeUnit::kNanoseconds) {
      out = out / 1000 - (out % 1000 < 0 ? 1 : 0);
      return false;
    }
    const auto factor = static_cast<int64_t>(us_per(unit));
    return factor != 1 && __builtin_mul_overflow(out, factor, &out);
  }
}

/// Calls visit(i, number) for a field of `count` records.
template <typename Visit>
void for_each_number(const uint8_t* records, const NumberField& field, size_t count, const Visit& visit) {
  const bool known = with_element_type(field.type, [&](auto type) {
    const uint8_t* next = records + field.offset;
    for (size_t i = 0; i < count; ++i, next += field.stride) visit(i, load_element<decltype(type)>(next));
  });
  E2LF_REQUIRE(known, "not a type of numbers: " + field.type);
}

/// Removes the events whose bad[i] is set, and returns their number.
size_t remove_bad(EventColumns& events, const Column<uint8_t>& bad) {
  if (std::find_if(bad.begin(), bad.end(), [](uint8_t b) { return b != 0; }) == bad.end()) return 0;
  size_t kept = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    if (bad[i] == 0) events.set(kept++, events[i]);
  }
  const size_t removed = events.size() - kept;
  events.resize(kept);
  return removed;
}

}  // namespace

bool is_number_type(const std::string& type) {
  return element_size(type) > 0;
}

template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad) {
  for_each_number(records, field, count, [&](size_t i, auto number) { bad[i] |= convert_one(number, out[i]); });
}

template void to_column(const uint8_t*, const NumberField&, size_t, uint8_t*, uint8_t*);
template void to_column(const uint8_t*, const NumberField&, size_t, uint16_t*, uint8_t*);

void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad) {
  for_each_number(records, field, count, [&](size_t i, auto number) { bad[i] |= convert_time(number, unit, out[i]); });
}

size_t to_events(const RecordsOfFields& records, const RecordFields& fields, size_t count, EventColumns& events) {
  events.resize(count);
  Column<uint8_t> bad(count, 0);
  to_column(records[of(Field::kX)], fields.x, count, events.x.data(), bad.data());
  to_column(records[of(Field::kY)], fields.y, count, events.y.data(), bad.data());
  for_each_number(records[of(Field::kP)], fields.p, count, [&](size_t i, auto number) {
    events.p[i] = fields.polarity.of(static_cast<double>(number));
    bad[i] |= events.p[i] == PolarityCode::kNone;
  });
  to_times(records[of(Field::kT)], fields.t, fields.unit, count, events.t.data(), bad.data());
  return remove_bad(events, bad);
}

std::vector<double> to_doubles(const uint8_t* records, const NumberField& field, size_t count) {
  std::vector<double> values(count);
  for_each_number(records, field, count, [&](size_t i, auto number) { values[i] = static_cast<double>(number); });
  return values;
}

TableSample::Column sample_of(std::string name, const uint8_t* records, const NumberField& field, size_t count) {
  TableSample::Column column{.name = std::move(name), .values = to_doubles(records, field, count)};
  column.mantissa_bits = field.type == "f2" ? 10 : field.type == "f4" ? 23 : 0;
  return column;
}

namespace {

/// Drops the unused rows of a table.
class UsedRows final : public EventBlocks {
 public:
  UsedRows(BlocksPtr blocks, int64_t zero_us) : blocks_(std::move(blocks)), zero_us_(zero_us) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    const EventColumns& events = block.events;
    const auto is_zero = [&](size_t i) {
      return events.t[i] == zero_us_ && events.x[i] == 0 && events.y[i] == 0 && events.p[i] == 0;
    };
    bool has_zeros = zeros_ > 0;
    for (size_t i = 0; i < events.size() && !has_zeros; ++i) has_zeros = is_zero(i);
    if (has_zeros) {
      used_.clear();
      for (size_t i = 0; i < events.size(); ++i) {
        if (is_zero(i) && has_begun_) {
          ++zeros_;
          continue;
        }
        end_run(summary);
        used_.push_back(events[i]);
        has_begun_ |= events.t[i] > zero_us_;
      }
      if (!more) end_run(summary);
      std::swap(block.events, used_);
    } else if (!events.empty()) {
      has_begun_ |= events.t.back() > zero_us_;
    }
    return more || !block.empty();
  }

  Result<void> seek_before(int64_t t_us) override {
    zeros_ = 0;
    has_begun_ = false;
    return blocks_->seek_before(t_us);
  }

 private:
  /// A few such rows may be events of a clock that starts again.
  static constexpr uint64_t kMostEvents = 7;

  void end_run(DecodeSummary& summary) {
    if (zeros_ > kMostEvents) {
      summary.add(Violation::kZeros, 0, zeros_);
      zeros_ = 0;
    }
    for (; zeros_ > 0; --zeros_) used_.push_back({0, 0, 0, zero_us_});
  }

  BlocksPtr blocks_;
  int64_t zero_us_;
  EventColumns used_;
  uint64_t zeros_ = 0;      ///< number of rows of zeros that were withheld
  bool has_begun_ = false;  ///< whether a later time preceded
};

/// Unwraps times of a signed or unsigned 32-bit clock that counts `unit`. A decrease by more than three quarters of its
/// range is a wrap (DecodeSummary::time_loops), and an increase by as much after a wrap is a late event. Other times
/// are unchanged. Seeking behind a wrap goes to the first block.
class UnwrappedBlocks final : public EventBlocks {
 public:
  UnwrappedBlocks(BlocksPtr blocks, TimeUnit unit)
      : blocks_(std::move(blocks)),
        is_ns_(unit == TimeUnit::kNanoseconds),
        us_per_unit_(std::max<int64_t>(1, std::llround(us_per(unit)))) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    for (int64_t& t_us : block.events.t) {
      const int64_t loops = loops_at(is_ns_ ? t_us : t_us / us_per_unit_, summary);
      if (loops != 0 && is_time(t_us)) t_us += is_ns_ ? loops * kCircle / 1000 : loops * kCircle * us_per_unit_;
    }
    return more;
  }

  Result<void> seek_before(int64_t t_us) override {
    last_.reset();
    loops_ = 0;
    return blocks_->seek_before(has_wrapped_ ? INT64_MIN : t_us);
  }

 private:
  static constexpr int64_t kCircle = int64_t{1} << 32;
  static constexpr int kMaxOdd = 16;

  /// In the units of the times; nanoseconds are in whole microseconds.
  [[nodiscard]] int64_t circle() const { return is_ns_ ? kCircle / 1000 : kCircle; }

  /// Returns how often the clock has wrapped around before a time.
  int64_t loops_at(int64_t time, DecodeSummary& summary) {
    if (time < -circle() / 2 || time > circle()) return loops_;  // not of 32 bits
    if (!last_) last_ = time;
    const int64_t step = time - *last_, quarter = circle() / 4;
    if (std::abs(step) <= quarter || step < -3 * quarter) {
      if (step < -3 * quarter) {
        ++loops_;
        ++summary.time_loops;
        has_wrapped_ = true;
      }
      last_ = time;
      odd_ = 0;
      return loops_;
    }
    if (step > 3 * quarter && loops_ > 0) return loops_ - 1;
    // Damage, or a pause if many times agree.
    if (++odd_ == kMaxOdd) last_.reset();
    return loops_;
  }

  BlocksPtr blocks_;
  bool is_ns_;
  int64_t us_per_unit_;
  std::optional<int64_t> last_;
  int64_t loops_ = 0;
  int odd_ = 0;
  bool has_wrapped_ = false;
};

}  // namespace

ReaderPtr make_table_reader(BlocksPtr blocks, TimeUnit unit, RecordingInfo info, const std::string& name,
                            const OpenOptions& options, TriggersPtr triggers, int64_t zero_us) {
  blocks = std::make_unique<UsedRows>(std::move(blocks), zero_us);
  blocks = std::make_unique<UnwrappedBlocks>(std::move(blocks), unit);
  return make_block_reader(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings::table
