#include "raykiln/base/metrics.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace raykiln::server {
namespace {

constexpr std::size_t kMaxSeries = 1000;

void add_to(std::atomic<double>& value, double amount) {
  double seen = value.load(std::memory_order_relaxed);
  while (!value.compare_exchange_weak(seen, seen + amount, std::memory_order_relaxed)) {
  }
}

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0.0 ? "+Inf" : "-Inf";
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string label_text(const Labels& labels) {
  std::string text;
  for (const auto& [key, value] : labels) {
    if (!text.empty()) text += ',';
    text += key + "=\"" + escaped(value) + '"';
  }
  return text;
}

std::string braced(const std::string& labels) { return labels.empty() ? "" : '{' + labels + '}'; }

std::string bucket_lines(const std::string& name, const std::string& labels,
                         const Histogram::Snapshot& shot) {
  std::string text;
  const std::string lead = name + "_bucket{" + labels + (labels.empty() ? "" : ",") + "le=\"";
  for (std::size_t i = 0; i < shot.cumulative.size(); ++i) {
    const std::string bound = i < shot.bounds.size() ? number(shot.bounds[i]) : "+Inf";
    text += lead + bound + "\"} " + std::to_string(shot.cumulative[i]) + '\n';
  }
  text += name + "_sum" + braced(labels) + ' ' + number(shot.sum) + '\n';
  text += name + "_count" + braced(labels) + ' ' + std::to_string(shot.cumulative.back()) + '\n';
  return text;
}

}  // namespace

void Counter::add(double amount) { add_to(value_, amount); }
void Gauge::add(double amount) { add_to(value_, amount); }

Histogram::Histogram(std::vector<double> bounds)
    : bounds_(std::move(bounds)), counts_(bounds_.size() + 1) {}

void Histogram::observe(double value) {
  const auto bucket = std::lower_bound(bounds_.begin(), bounds_.end(), value) - bounds_.begin();
  const std::scoped_lock lock(mutex_);
  ++counts_[static_cast<std::size_t>(bucket)];
  sum_ += value;
}

Histogram::Snapshot Histogram::snapshot() const {
  const std::scoped_lock lock(mutex_);
  Snapshot shot{bounds_, counts_, sum_};
  for (std::size_t i = 1; i < shot.cumulative.size(); ++i) {
    shot.cumulative[i] += shot.cumulative[i - 1];
  }
  return shot;
}

MetricsRegistry::Series& MetricsRegistry::series(const std::string& name, const std::string& help,
                                                 const char* type, const Labels& labels) {
  Family& family = families_[name];
  if (family.help.empty()) family.help = help;
  if (*family.type == '\0') family.type = type;
  if (std::string_view(family.type) != type) throw std::logic_error("metric of two types: " + name);
  Labels used = labels;
  if (!family.series.contains(label_text(labels)) && family.series.size() >= kMaxSeries) {
    for (auto& label : used) label.second = "other";
  }
  Series& entry = family.series[label_text(used)];
  entry.labels = std::move(used);
  return entry;
}

Counter& MetricsRegistry::counter(const std::string& name, const std::string& help,
                                  const Labels& labels) {
  const std::scoped_lock lock(mutex_);
  auto& slot = series(name, help, "counter", labels).counter;
  if (!slot) slot = std::make_unique<Counter>();
  return *slot;
}

Gauge& MetricsRegistry::gauge(const std::string& name, const std::string& help,
                              const Labels& labels) {
  const std::scoped_lock lock(mutex_);
  auto& slot = series(name, help, "gauge", labels).gauge;
  if (!slot) slot = std::make_unique<Gauge>();
  return *slot;
}

Histogram& MetricsRegistry::histogram(const std::string& name, const std::string& help,
                                      const std::vector<double>& bounds, const Labels& labels) {
  const std::scoped_lock lock(mutex_);
  auto& slot = series(name, help, "histogram", labels).histogram;
  if (!slot) slot = std::make_unique<Histogram>(bounds);
  return *slot;
}

std::string MetricsRegistry::prometheus_text() const {
  const std::scoped_lock lock(mutex_);
  std::string text;
  for (const auto& [name, family] : families_) {
    text += "# HELP " + name + ' ' + escaped(family.help) + "\n# TYPE " + name + ' ' + family.type + '\n';
    for (const auto& [labels, entry] : family.series) {
      if (entry.counter) text += name + braced(labels) + ' ' + number(entry.counter->value()) + '\n';
      if (entry.gauge) text += name + braced(labels) + ' ' + number(entry.gauge->value()) + '\n';
      if (entry.histogram) text += bucket_lines(name, labels, entry.histogram->snapshot());
    }
  }
  return text;
}

}  // namespace raykiln::server
