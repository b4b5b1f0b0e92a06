#include "json_lines.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>

#include <simdjson.h>

#include "errors.hpp"
#include "numbers.hpp"

namespace graze {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kLargestLine = std::size_t{1} << 28;  // a guard against input that is no text at all

}  // namespace

// --------------------------------------------------------------------------------------------------- lines

LineReader::LineReader(const std::string& path) : name_(path.empty() || path == "-" ? "<stdin>" : path) {
  file_ = name_ == "<stdin>" ? stdin : std::fopen(path.c_str(), "rb");
  if (file_ == nullptr) throw DataError(fmt::format("{}: cannot read: {}", path, std::strerror(errno)));
  buffer_.resize(kChunk + kPadding);
}

LineReader::~LineReader() {
  if (file_ != stdin) std::fclose(file_);
}

bool LineReader::fill() {
  if (at_end_) return false;
  // Keep what is left of the current line at the front, and make room for a longer one.
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ + kPadding >= buffer_.size()) {
    if (buffer_.size() >= kLargestLine)
      throw DataError(fmt::format("{}:{}: line too long", name_, line_ + 1));
    buffer_.resize(2 * buffer_.size());
  }
  const std::size_t read = std::fread(buffer_.data() + end_, 1, buffer_.size() - kPadding - end_, file_);
  if (std::ferror(file_) != 0)
    throw EnvironmentError(fmt::format("{}: read failed: {}", name_, std::strerror(errno)));
  end_ += read;
  at_end_ = read == 0;
  return read > 0;
}

std::optional<std::string_view> LineReader::next() {
  std::size_t searched = 0;
  while (true) {
    const char* const start = buffer_.data() + begin_;
    const auto* const newline =
        static_cast<const char*>(std::memchr(start + searched, '\n', end_ - begin_ - searched));
    std::string_view line;
    if (newline != nullptr) {
      line = {start, static_cast<std::size_t>(newline - start)};
      begin_ += line.size() + 1;
    } else {
      searched = end_ - begin_;
      if (fill()) continue;
      if (begin_ == end_) return std::nullopt;
      line = {buffer_.data() + begin_, end_ - begin_};
      begin_ = end_;
    }
    ++line_;
    searched = 0;
    if (line.find_first_not_of(" \t\r") != std::string_view::npos) return line;
  }
}

// -------------------------------------------------------------------------------------------------- parsing

namespace ondemand = simdjson::ondemand;

struct JsonParser::Implementation {
  ondemand::parser parser;

  ondemand::document open(std::string_view line) {
    return parser.iterate(
        simdjson::padded_string_view(line.data(), line.size(), line.size() + LineReader::kPadding));
  }
  /// A finite number: decimal, or a hex-float string.
  static std::optional<double> number(ondemand::value value) {
    double result = 0;
    ondemand::json_type type{};
    if (value.type().get(type) != simdjson::SUCCESS) return std::nullopt;
    if (type == ondemand::json_type::number) {
      if (value.get_double().get(result) != simdjson::SUCCESS) return std::nullopt;
    } else if (type == ondemand::json_type::string) {
      std::string_view text;
      if (value.get_string().get(text) != simdjson::SUCCESS) return std::nullopt;
      const auto parsed = parse_hex_float(text);
      if (!parsed) return std::nullopt;
      result = *parsed;
    } else {
      return std::nullopt;
    }
    return std::isfinite(result) ? std::optional(result) : std::nullopt;
  }
  /// All numbers of a list; false if it is none.
  static bool numbers(ondemand::value value, std::vector<double>& out) {
    out.clear();
    ondemand::array list;
    if (value.get_array().get(list) != simdjson::SUCCESS) return false;
    for (auto entry : list) {
      ondemand::value item;
      if (entry.get(item) != simdjson::SUCCESS) return false;
      const auto parsed = number(item);
      if (!parsed) return false;
      out.push_back(*parsed);
    }
    return true;
  }
  std::vector<double> scratch;
};

JsonParser::JsonParser() : implementation_(std::make_unique<Implementation>()) {}
JsonParser::~JsonParser() = default;

namespace {

LineError field_error(std::string_view field, std::string_view what) {
  return {fmt::format("field '{}': {}", field, what)};
}
/// Was the object the whole line?
bool at_end(ondemand::document& document) {
  return document.current_location().error() == simdjson::OUT_OF_BOUNDS;
}
LineError syntax_error(const char* what) { return {fmt::format("not a JSON object: {}", what)}; }

}  // namespace

std::optional<LineError> JsonParser::parse(std::string_view line, Ray& ray) {
  try {
    ondemand::document document = implementation_->open(line);
    ondemand::object object = document.get_object();
    bool has_o = false, has_d = false;
    std::vector<double>& v = implementation_->scratch;
    for (auto field : object) {
      const std::string_view key = field.unescaped_key();
      if (key != "o" && key != "d") continue;
      if (!Implementation::numbers(field.value(), v) || v.size() != 3) {
        return field_error(key, "expected three finite numbers (decimal, or hex-float strings)");
      }
      (key == "o" ? ray.o : ray.d) = {v[0], v[1], v[2]};
      (key == "o" ? has_o : has_d) = true;
    }
    if (!at_end(document)) return syntax_error("something follows the object");
    if (!has_o) return field_error("o", "missing");
    if (!has_d) return field_error("d", "missing");
    if (max_abs(ray.d) == 0) return field_error("d", "zero direction");
    return std::nullopt;
  } catch (const simdjson::simdjson_error& error) {
    return syntax_error(error.what());
  }
}

std::optional<LineError> JsonParser::parse(std::string_view line, Polynomial& polynomial) {
  polynomial.interval.reset();
  try {
    ondemand::document document = implementation_->open(line);
    ondemand::object object = document.get_object();
    bool has_c = false;
    std::vector<double>& v = implementation_->scratch;
    for (auto field : object) {
      const std::string_view key = field.unescaped_key();
      if (key == "c") {
        has_c = Implementation::numbers(field.value(), polynomial.c) && !polynomial.c.empty();
        if (!has_c)
          return field_error("c", "expected a list of finite numbers (decimal, or hex-float strings)");
      } else if (key == "interval") {
        if (!Implementation::numbers(field.value(), v) || v.size() != 2 || v[0] > v[1]) {
          return field_error("interval", "expected [a,b] with a <= b, both finite");
        }
        polynomial.interval = {v[0], v[1]};
      }
    }
    if (!at_end(document)) return syntax_error("something follows the object");
    if (!has_c) return field_error("c", "missing");
    return std::nullopt;
  } catch (const simdjson::simdjson_error& error) {
    return syntax_error(error.what());
  }
}

bool read_batch(LineReader& reader, JsonParser& parser, bool keep_going, RayBatch& batch,
                std::optional<std::string>& stop) {
  batch.rays.clear();
  batch.errors.clear();
  while (batch.rays.size() < kBatch) {
    const auto line = reader.next();
    if (!line) break;
    Ray ray;
    if (const auto error = parser.parse(*line, ray)) {
      if (!keep_going) {
        stop = fmt::format("{}:{}: {}", reader.name(), reader.line(), error->message);
        break;
      }
      batch.errors.emplace_back(batch.rays.size(), error->message);
      ray = {};  // a zero direction: invalid to everyone
    }
    batch.rays.push_back(ray);
  }
  return !batch.rays.empty();
}

// --------------------------------------------------------------------------------------------------- output

void Output::write_if_large() {
  if (buffer_.size() >= kChunk) flush();
}

void Output::flush() {
  const bool written = std::fwrite(buffer_.data(), 1, buffer_.size(), stdout) == buffer_.size();
  if (!written || std::fflush(stdout) != 0) {
    throw EnvironmentError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
  buffer_.clear();
}

void append_json_string(fmt::memory_buffer& out, std::string_view s) {
  out.push_back('"');
  for (const char c : s) {
    if (c == '"' || c == '\\') {
      out.push_back('\\');
      out.push_back(c);
    } else if (static_cast<unsigned char>(c) < 0x20) {
      fmt::format_to(std::back_inserter(out), "\\u{:04x}",
                     static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out.push_back(c);
    }
  }
  out.push_back('"');
}

}  // namespace graze
