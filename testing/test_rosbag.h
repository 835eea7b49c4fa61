// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/formats/codecs.h"
#ifdef E2LF_HAVE_SQLITE
#include <sqlite3.h>
#endif

/// Builds ROS 2 bags, for tests and fuzzing.
namespace e2lf::formats::rosbag {

using Bytes = std::vector<uint8_t>;

inline constexpr const char* kPacketType = "event_camera_msgs/msg/EventPacket";
inline constexpr const char* kListType = "dvs_msgs/msg/EventArray";

/// Writes the fields of a message in CDR after its four-byte header.
class MessageWriter {
 public:
  template <typename T>
  void put(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    bytes_.resize(bytes_.size() + sizeof(T));
    store_le(bytes_.data() + bytes_.size() - sizeof(T), value);
  }
  void put_text(std::string_view text) {
    put(static_cast<uint32_t>(text.size() + 1));
    for (const char c : text) bytes_.push_back(static_cast<uint8_t>(c));
    bytes_.push_back(0);
  }
  void put_header(uint32_t width, uint32_t height) {
    put<int32_t>(1700000000);
    put<uint32_t>(0);
    put_text("camera");
    put(height);
    put(width);
  }
  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_ = {0, 1, 0, 0};
};

inline Bytes packet_message(uint64_t number, std::string_view encoding, uint64_t base_ns, const Bytes& payload,
                            uint32_t width = 640, uint32_t height = 480) {
  MessageWriter message;
  message.put_header(width, height);
  message.put(number);
  message.put(base_ns);
  message.put_text(encoding);
  message.put<uint8_t>(0);
  message.put(static_cast<uint32_t>(payload.size()));
  for (const uint8_t byte : payload) message.put(byte);
  return message.take();
}

/// Makes a message from events whose times are in us since 1970.
inline Bytes list_message(const EventColumns& events) {
  MessageWriter message;
  message.put_header(640, 480);
  message.put(static_cast<uint32_t>(events.size()));
  for (size_t i = 0; i < events.size(); ++i) {
    message.put(events.x[i]);
    message.put(events.y[i]);
    message.put(static_cast<int32_t>(events.t[i] / 1'000'000));
    message.put(static_cast<uint32_t>(events.t[i] % 1'000'000 * 1000));
    message.put(events.p[i]);
  }
  return message.take();
}

template <typename T>
Bytes words(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  for (size_t i = 0; i < values.size(); ++i) store_le(&bytes[i * sizeof(T)], values[i]);
  return bytes;
}

struct TestTopic {
  std::string name, type = kPacketType;
};

/// Messages as (number of the topic, contents).
using TestMessages = std::vector<std::pair<size_t, Bytes>>;

inline void put_record(Bytes& file, uint8_t kind, const Bytes& contents) {
  file.push_back(kind);
  file.resize(file.size() + 8);
  store_le<uint64_t>(file.data() + file.size() - 8, contents.size());
  file.insert(file.end(), contents.begin(), contents.end());
}

class RecordWriter {
 public:
  template <typename T>
  RecordWriter& put(T value) {
    bytes.resize(bytes.size() + sizeof(T));
    store_le(bytes.data() + bytes.size() - sizeof(T), value);
    return *this;
  }
  RecordWriter& put_text(std::string_view text) {
    put(static_cast<uint32_t>(text.size()));
    for (const char c : text) bytes.push_back(static_cast<uint8_t>(c));
    return *this;
  }
  Bytes bytes;
};

/// Makes an MCAP file. `pack` compresses its single chunk by the algorithm `name`; without it, there is no chunk.
inline Bytes mcap_file(const std::vector<TestTopic>& topics, const TestMessages& messages, std::string_view name = "",
                       Bytes (*pack)(const Bytes&) = nullptr) {
  Bytes records;
  for (size_t i = 0; i < topics.size(); ++i) {
    const auto id = static_cast<uint16_t>(i + 1);
    RecordWriter schema, channel;
    schema.put(id).put_text(topics[i].type).put_text("ros2msg").put_text("");
    put_record(records, 3, schema.bytes);
    channel.put(id).put(id).put_text(topics[i].name).put_text("cdr").put<uint32_t>(0);
    put_record(records, 4, channel.bytes);
  }
  const Bytes summary = records;
  uint32_t number = 0;
  for (const auto& [topic, contents] : messages) {
    RecordWriter message;
    message.put(static_cast<uint16_t>(topic + 1)).put(number++).put<uint64_t>(0).put<uint64_t>(0);
    message.bytes.insert(message.bytes.end(), contents.begin(), contents.end());
    put_record(records, 5, message.bytes);
  }
  Bytes file = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  put_record(file, 1, RecordWriter().put_text("ros2").put_text("test").bytes);
  if (pack == nullptr) {
    file.insert(file.end(), records.begin(), records.end());
  } else {
    const Bytes packed = pack(records);
    RecordWriter chunk;
    chunk.put<uint64_t>(0).put<uint64_t>(0).put<uint64_t>(records.size()).put<uint32_t>(0).put_text(name);
    chunk.put<uint64_t>(packed.size());
    chunk.bytes.insert(chunk.bytes.end(), packed.begin(), packed.end());
    put_record(file, 6, chunk.bytes);
  }
  put_record(file, 0x0F, RecordWriter().put<uint32_t>(0).bytes);
  const uint64_t begin = file.size();
  file.insert(file.end(), summary.begin(), summary.end());
  put_record(file, 2, RecordWriter().put(begin).put<uint64_t>(0).put<uint32_t>(0).bytes);
  file.insert(file.end(), {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'});
  return file;
}

#ifdef E2LF_HAVE_SQLITE
/// Returns the bytes of a database as rosbag2 stores it.
inline Bytes sqlite_file(const std::vector<TestTopic>& topics, const TestMessages& messages) {
  sqlite3* database = nullptr;
  sqlite3_open(":memory:", &database);
  sqlite3_exec(database,
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
               "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
               "data BLOB NOT NULL);",
               nullptr, nullptr, nullptr);
  sqlite3_stmt* statement = nullptr;
  const auto step = [&] {
    sqlite3_step(statement);
    sqlite3_reset(statement);
  };
  sqlite3_prepare_v2(database, "INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", -1, &statement, nullptr);
  for (size_t i = 0; i < topics.size(); ++i) {
    sqlite3_bind_int64(statement, 1, static_cast<int64_t>(i + 1));
    sqlite3_bind_text(statement, 2, topics[i].name.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(statement, 3, topics[i].type.c_str(), -1, SQLITE_TRANSIENT);
    step();
  }
  sqlite3_finalize(statement);
  sqlite3_prepare_v2(database, "INSERT INTO messages VALUES(NULL, ?, 0, ?)", -1, &statement, nullptr);
  for (const auto& [topic, contents] : messages) {
    sqlite3_bind_int64(statement, 1, static_cast<int64_t>(topic + 1));
    sqlite3_bind_blob(statement, 2, contents.data(), static_cast<int>(contents.size()), SQLITE_TRANSIENT);
    step();
  }
  sqlite3_finalize(statement);
  sqlite3_int64 size = 0;
  unsigned char* const image = sqlite3_serialize(database, "main", &size, 0);
  Bytes bytes(image, image + size);
  sqlite3_free(image);
  sqlite3_close(database);
  return bytes;
}
#endif

}  // namespace e2lf::formats::rosbag
