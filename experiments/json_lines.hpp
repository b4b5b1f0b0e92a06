// Rays, polynomials and hits as JSON Lines: streamed, so that memory stays flat for any number of lines.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// Reads a file or standard input line by line in large chunks. Lines are views that live until the next
/// call.
class LineReader {
 public:
  /// "-" or empty: standard input. Throws DataError if the file cannot be opened.
  explicit LineReader(const std::string& path);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// The next line without its end, or nothing at the end of input. Blank lines count but are passed over.
  /// At least kPadding readable bytes follow the line. Throws EnvironmentError if reading fails.
  std::optional<std::string_view> next();
  /// Number of the line that `next` returned last, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  static constexpr std::size_t kPadding = 64;  ///< simdjson reads up to this far past the end

 private:
  bool fill();

  std::string name_;
  std::FILE* file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t line_ = 0;
  bool at_end_ = false;
};

/// A line that could not be read as what it should be: what is wrong with which field.
struct LineError {
  std::string message;
};

/// Parses lines; one parser a thread.
class JsonParser {
 public:
  JsonParser();
  ~JsonParser();

  struct Polynomial {
    std::vector<double> c;
    std::optional<std::pair<double, double>> interval;
  };

  /// {"o":[x,y,z],"d":[x,y,z]}: three finite numbers each (decimal or hex-float strings), d not zero.
  std::optional<LineError> parse(std::string_view line, Ray& ray);
  /// {"c":[c0,c1,...],"interval":[a,b]}; the interval may be missing.
  std::optional<LineError> parse(std::string_view line, Polynomial& polynomial);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Text on its way to standard output. Throws EnvironmentError if it cannot be written (full disk).
class Output {
 public:
  fmt::memory_buffer& buffer() { return buffer_; }
  void write_if_large();
  void flush();

 private:
  fmt::memory_buffer buffer_;
};

/// Appends "s" as a JSON string.
void append_json_string(fmt::memory_buffer& out, std::string_view s);

/// Rays read and answered at a time.
inline constexpr std::size_t kBatch = 8192;

/// A batch of lines as rays; lines that are none have their error and an invalid ray in its place.
struct RayBatch {
  std::vector<Ray> rays;
  std::vector<std::pair<std::size_t, std::string>> errors;  ///< index in the batch, message
};

/// Reads up to kBatch rays. With keep_going a bad line becomes an invalid ray with an error; without, reading
/// stops before it and `stop` holds the message "FILE:LINE: ..." to end with once the batch is answered.
bool read_batch(LineReader& reader, JsonParser& parser, bool keep_going, RayBatch& batch,
                std::optional<std::string>& stop);

}  // namespace graze
