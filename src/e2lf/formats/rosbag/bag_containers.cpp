// SPDX-License-Identifier: MIT
// The containers of a bag, MCAP files, SQLite databases and folders of them; declared in bag.h.
#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/rosbag/bag.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/io/decompress.h"
#ifdef E2LF_HAVE_SQLITE
#include <sqlite3.h>
#endif

/// MCAP as specified at mcap.dev: records with a kind (u8), a length (u64) and content; chunks contain records.
namespace e2lf::formats::rosbag {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr size_t kRecordHeader = 9, kFooterBytes = 20;
constexpr uint8_t kFooter = 0x02, kSchema = 0x03, kChannel = 0x04, kMessage = 0x05, kChunk = 0x06, kDataEnd = 0x0F;
/// Largest number of topics; further ones are skipped.
constexpr size_t kMaxTopics = 1000;

std::string text_of(Contents& fields) {
  return std::string(as_text(fields.take(fields.number<uint32_t>())));
}

std::optional<Compression> compression_of(const std::string& name) {
  if (name.empty()) return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  return name == "zstd" ? std::optional(Compression::kZstd) : std::nullopt;
}

class McapBag final : public Bag {
 public:
  explicit McapBag(SourcePtr source) : source_(std::move(source)) {}

  Result<void> open() {
    E2LF_ASSIGN_OR_RETURN(const auto head, source_->fetch(kMagic.size()));
    if (!detect_mcap(head))
      return fail(ErrorCode::kFormat, source_->name(), "this is not an MCAP file, or it is incomplete");
    source_->consume(kMagic.size());
    // The topic of the first message precedes it and is then the first one.
    BagMessage first;
    E2LF_ASSIGN_OR_RETURN(const bool more, next(first, losses_of_first_));
    if (!source_->seekable()) {
      if (more) first_ = first;
      return {};
    }
    losses_of_first_ = {};
    E2LF_RETURN_IF_ERROR(read_summary());
    return rewind();
  }

  std::vector<Topic> topics() const override {
    std::vector<Topic> all;
    for (const Channel& channel : channels_) all.push_back(channel.topic);
    return all;
  }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    summary.add_losses(std::exchange(losses_of_first_, {}));
    if (first_) {
      message = *std::exchange(first_, std::nullopt);
      return true;
    }
    for (;;) {
      if (!records_.empty()) {
        if (next_in_chunk(message, summary)) return true;
        continue;
      }
      source_->consume(std::exchange(used_, 0));
      position_ = source_->position();
      E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kRecordHeader));
      if (bytes.size() < kRecordHeader) return end(Violation::kTruncated, summary);
      const uint8_t kind = bytes[0];
      const auto length = load_le<uint64_t>(&bytes[1]);
      if (kind == kDataEnd || kind == kFooter) return end(std::nullopt, summary);
      // The position of the next record is unknown.
      if (kind == 0 || length > kMaxPacketBytes) return end(Violation::kMisaligned, summary);
      E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(kRecordHeader + length));
      if (bytes.size() < kRecordHeader + length) return end(Violation::kTruncated, summary);
      used_ = kRecordHeader + static_cast<size_t>(length);
      const auto contents = bytes.subspan(kRecordHeader, static_cast<size_t>(length));
      if (kind == kChunk) {
        E2LF_RETURN_IF_ERROR(open_chunk(contents, summary));
      } else if (take_record(kind, contents, message)) {
        return true;
      }
    }
  }

  Result<void> rewind() override {
    records_ = {};
    used_ = 0;
    has_ended_ = false;
    return source_->seek(kMagic.size());
  }

 private:
  struct Channel {
    uint16_t id = 0;
    Topic topic;
  };

  /// Decompresses a chunk to records_; one that cannot be decompressed is counted.
  Result<void> open_chunk(std::span<const uint8_t> contents, DecodeSummary& summary) {
    Contents fields(contents);
    fields.take(28);  // times, size and check sum of the records
    const std::string name = text_of(fields);
    const auto compression = compression_of(name);
    if (!compression && !fields.is_cut()) {
      return fail(ErrorCode::kUnsupported, source_->name(),
                  "the chunks are compressed with an unknown algorithm; convert the bag to lz4 or zstd");
    }
    const auto packed = fields.take(fields.number<uint64_t>());
    const bool is_whole = !fields.is_cut() && compression.has_value();
    if (is_whole) E2LF_RETURN_IF_ERROR(check_compression(*compression));
    if (is_whole && decompress(*compression, packed, unpacked_)) {
      records_ = unpacked_;
    } else {
      summary.add_dropped(Violation::kBadRecord, position_);
    }
    return {};
  }

  /// Reads the next record of the chunk; returns whether it is a message.
  bool next_in_chunk(BagMessage& message, DecodeSummary& summary) {
    Contents fields(records_);
    const auto kind = fields.number<uint8_t>();
    const auto contents = fields.take(fields.number<uint64_t>());
    if (fields.is_cut()) {
      summary.add(Violation::kBadRecord, position_);
      records_ = {};
      return false;
    }
    records_ = fields.rest();
    return take_record(kind, contents, message);
  }

  /// Stores schemas and channels; returns whether the record is a message of an event topic.
  bool take_record(uint8_t kind, std::span<const uint8_t> contents, BagMessage& message) {
    Contents fields(contents);
    const auto id = fields.number<uint16_t>();
    if (kind == kSchema && types_.size() < kMaxTopics) types_.emplace(id, text_of(fields));
    if (kind != kChannel && kind != kMessage) return false;
    const auto channel = std::ranges::find_if(channels_, [id](const Channel& candidate) { return candidate.id == id; });
    if (kind == kChannel && channel == channels_.end() && channels_.size() < kMaxTopics) {
      const auto type = types_.find(fields.number<uint16_t>());
      if (type != types_.end() && is_event_type(type->second))
        channels_.push_back({id, {text_of(fields), type->second}});
    }
    if (kind == kChannel || channel == channels_.end()) return false;
    fields.take(20);  // number and times
    if (fields.is_cut()) return false;
    message = {&channel->topic, fields.rest(), position_};
    return true;
  }

  /// Reads schemas and channels from the end of the file, if they are there.
  Result<void> read_summary() {
    const uint64_t size = source_->size().value_or(0), tail = kRecordHeader + kFooterBytes + kMagic.size();
    if (size < tail + kMagic.size()) return {};
    E2LF_RETURN_IF_ERROR(source_->seek(size - tail));
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(tail));
    if (bytes.size() < tail || bytes[0] != kFooter) return {};
    const auto begin = load_le<uint64_t>(&bytes[kRecordHeader]);
    if (begin == 0 || begin > size - tail || size - tail - begin > kMaxPacketBytes) return {};
    E2LF_RETURN_IF_ERROR(source_->seek(begin));
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(size - tail - begin));
    Contents summary(bytes.first(std::min<size_t>(bytes.size(), size - tail - begin)));
    while (!summary.rest().empty() && !summary.is_cut()) {
      BagMessage none;
      const auto kind = summary.number<uint8_t>();
      const auto contents = summary.take(summary.number<uint64_t>());
      if (kind == kSchema || kind == kChannel) take_record(kind, contents, none);
    }
    return {};
  }

  Result<bool> end(std::optional<Violation> violation, DecodeSummary& summary) {
    if (!std::exchange(has_ended_, true) && violation) summary.add(*violation, position_);
    return false;
  }

  SourcePtr source_;
  std::map<uint16_t, std::string> types_;
  std::deque<Channel> channels_;     ///< event topics in the order in which the file names them
  std::optional<BagMessage> first_;  ///< for a stream: read to determine its topic, and not returned yet
  DecodeSummary losses_of_first_;
  std::vector<uint8_t> unpacked_;
  std::span<const uint8_t> records_;  ///< records of the chunk that were not read yet
  size_t used_ = 0;                   ///< number of available bytes that the last record occupies
  uint64_t position_ = 0;             ///< of the last record
  bool has_ended_ = false;
};

}  // namespace

bool detect_mcap(std::span<const uint8_t> head) {
  return as_text(head).starts_with(kMagic);
}

Result<BagPtr> open_mcap_bag(SourcePtr source) {
  auto bag = std::make_unique<McapBag>(std::move(source));
  E2LF_RETURN_IF_ERROR(bag->open());
  return BagPtr(std::move(bag));
}

#ifdef E2LF_HAVE_SQLITE
namespace {

/// Pages of a damaged database may form a cycle. A statement that takes more steps than this between two rows is
/// aborted, and also after a stop request.
constexpr int kStepsPerLook = 1'000'000;
constexpr int kMaxLooks = 20;

struct Closer {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Closer>;
using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

/// Returns the path as a URI, in which special characters are escaped.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '_' || c == '-') {
      uri += c;
    } else {
      uri += formatted("%%%02X", byte);
    }
  }
  // A recorder that was killed left the last messages in a journal, which only a writable database reads.
  std::filesystem::path journal = path;
  journal += "-wal";
  return uri + (is_present(journal) ? "?mode=ro" : "?mode=ro&immutable=1");
}

class SqliteBag final : public Bag {
 public:
  SqliteBag(SourcePtr source) : name_(source->name()), source_(std::move(source)) {}

  Result<void> open() {
    sqlite3* database = nullptr;
    const bool is_file = !source_->path().empty();
    const std::string uri = is_file ? uri_of(source_->path()) : ":memory:";
    const int flags = SQLITE_OPEN_URI | (is_file ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE);
    const int state = sqlite3_open_v2(uri.c_str(), &database, flags, nullptr);
    database_.reset(database);
    if (state != SQLITE_OK) return failure();
    if (!is_file) E2LF_RETURN_IF_ERROR(read_into_memory());
    // The file has no control: no code of its schema is run, and nothing larger than a message is allocated.
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxPacketBytes));
    sqlite3_progress_handler(database, kStepsPerLook, &SqliteBag::look, this);
    E2LF_RETURN_IF_ERROR(read_topics());
    return rewind();
  }

  std::vector<Topic> topics() const override {
    std::vector<Topic> all;
    for (const auto& [id, topic] : topics_) all.push_back(topic);
    return all;
  }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    while (messages_ != nullptr) {
      looks_ = 0;
      const int state = sqlite3_step(messages_.get());
      if (state != SQLITE_ROW) {
        messages_.reset();
        if (state != SQLITE_DONE && !stop_requested()) summary.add(Violation::kTruncated, row_);
        return false;
      }
      row_ = static_cast<uint64_t>(sqlite3_column_int64(messages_.get(), 0));
      const auto topic = topics_.find(sqlite3_column_int64(messages_.get(), 1));
      if (topic == topics_.end()) continue;
      const void* const data = sqlite3_column_blob(messages_.get(), 2);
      const auto size = static_cast<size_t>(sqlite3_column_bytes(messages_.get(), 2));
      message = {&topic->second, {static_cast<const uint8_t*>(data), data == nullptr ? 0 : size}, row_};
      return true;
    }
    return false;
  }

  Result<void> rewind() override { return prepare("SELECT id, topic_id, data FROM messages ORDER BY id", messages_); }

 private:
  static int look(void* self) {
    auto* const bag = static_cast<SqliteBag*>(self);
    return ++bag->looks_ > kMaxLooks || stop_requested() ? 1 : 0;
  }

  Error failure() const {
    const char* const why = database_ == nullptr ? "no memory" : sqlite3_errmsg(database_.get());
    return fail(ErrorCode::kFormat, name_, "SQLite cannot read this as a bag of ROS 2 (", why,
                "); it is not one, or incomplete; copy it again");
  }

  Result<void> prepare(const char* query, Statement& statement) const {
    sqlite3_stmt* prepared = nullptr;
    const int state = sqlite3_prepare_v2(database_.get(), query, -1, &prepared, nullptr);
    statement.reset(prepared);
    return state == SQLITE_OK ? Result<void>() : failure();
  }

  Result<void> read_into_memory() {
    E2LF_ASSIGN_OR_RETURN(bytes_, read_rest(*source_));
    const auto size = static_cast<sqlite3_int64>(bytes_.size());
    const int state =
        sqlite3_deserialize(database_.get(), "main", bytes_.data(), size, size, SQLITE_DESERIALIZE_READONLY);
    return state == SQLITE_OK ? Result<void>() : failure();
  }

  Result<void> read_topics() {
    Statement statement;
    E2LF_RETURN_IF_ERROR(prepare("SELECT id, name, type FROM topics ORDER BY id LIMIT 10000", statement));
    const auto text = [&statement](int column) {
      const auto* const value = reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
      return std::string(value == nullptr ? "" : value);
    };
    int state = SQLITE_ROW;
    while ((state = sqlite3_step(statement.get())) == SQLITE_ROW) {
      Topic topic{text(1), text(2)};
      if (is_event_type(topic.type)) topics_[sqlite3_column_int64(statement.get(), 0)] = std::move(topic);
    }
    return state == SQLITE_DONE ? Result<void>() : failure();
  }

  std::string name_;
  SourcePtr source_;
  std::vector<uint8_t> bytes_;  ///< of a database that is in memory; outlives it
  Database database_;
  Statement messages_;  ///< null after the last one
  std::map<int64_t, Topic> topics_;
  uint64_t row_ = 0;
  int looks_ = 0;
};

}  // namespace

Result<BagPtr> open_sqlite_bag(SourcePtr source) {
  auto bag = std::make_unique<SqliteBag>(std::move(source));
  E2LF_RETURN_IF_ERROR(bag->open());
  return BagPtr(std::move(bag));
}

#else

Result<BagPtr> open_sqlite_bag(SourcePtr source) {
  return fail(ErrorCode::kMissingDependency, source->name(),
              "this is a bag of ROS 2 stored by SQLite; build with libsqlite3-dev installed, or convert it to MCAP");
}

#endif

namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxFiles = 100'000;

std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files = paths_in(folder);
  std::erase_if(files, [](const fs::path& path) { return path.extension() != ".db3" && path.extension() != ".mcap"; });
  files.resize(std::min(files.size(), kMaxFiles));
  std::ranges::sort(files, is_before_in_number_order);
  return files;
}

class BagFiles final : public Bag {
 public:
  explicit BagFiles(std::vector<fs::path> files) : files_(std::move(files)) {}

  std::vector<Topic> topics() const override { return bag_->topics(); }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const bool more, bag_->next(message, summary));
      if (more) return true;
      if (file_ + 1 >= files_.size()) return false;
      E2LF_RETURN_IF_ERROR(open(file_ + 1));
    }
  }

  Result<void> rewind() override { return open(0); }

  Result<void> open(size_t file) {
    file_ = file;
    E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(files_[file]));
    E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
    E2LF_ASSIGN_OR_RETURN(bag_,
                          detect_mcap(head) ? open_mcap_bag(std::move(source)) : open_sqlite_bag(std::move(source)));
    return {};
  }

 private:
  std::vector<fs::path> files_;
  BagPtr bag_;
  size_t file_ = 0;
};

}  // namespace

bool is_bag_folder(const fs::path& path) {
  return is_folder(path) && !files_of_folder(path).empty();
}

Result<BagPtr> open_folder_bag(const fs::path& folder) {
  std::vector<fs::path> files = files_of_folder(folder);
  if (files.empty()) return fail(ErrorCode::kNotFound, folder, "the folder contains no files of a bag");
  auto bag = std::make_unique<BagFiles>(std::move(files));
  E2LF_RETURN_IF_ERROR(bag->open(0));
  return BagPtr(std::move(bag));
}

}  // namespace e2lf::formats::rosbag
