// Counters, gauges and histograms, made in main and passed in.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace raykiln::server {

/// Only ever rises. Safe to use from any thread, as are the other two.
class Counter {
 public:
  void add(double amount = 1.0);
  [[nodiscard]] double value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> value_{0.0};
};

class Gauge {
 public:
  void set(double value) { value_.store(value, std::memory_order_relaxed); }
  void add(double amount);
  [[nodiscard]] double value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> value_{0.0};
};

class Histogram {
 public:
  /// `bounds`: upper bounds of the buckets, ascending; +Inf is added.
  explicit Histogram(std::vector<double> bounds);
  void observe(double value);

  struct Snapshot {
    std::vector<double> bounds;
    std::vector<std::uint64_t> cumulative;  ///< one more than bounds: the last is the count
    double sum = 0.0;
  };
  [[nodiscard]] Snapshot snapshot() const;

 private:
  mutable std::mutex mutex_;
  std::vector<double> bounds_;
  std::vector<std::uint64_t> counts_;
  double sum_ = 0.0;
};

using Labels = std::vector<std::pair<std::string, std::string>>;

/// Owner of all metrics. A second request for the same name and labels returns the same object; the
/// references live as long as the registry. At most 1000 label sets a name, the rest share one with
/// every value "other", so that hostile requests cannot make it grow.
class MetricsRegistry {
 public:
  Counter& counter(const std::string& name, const std::string& help, const Labels& labels = {});
  Gauge& gauge(const std::string& name, const std::string& help, const Labels& labels = {});
  Histogram& histogram(const std::string& name, const std::string& help,
                       const std::vector<double>& bounds, const Labels& labels = {});

  /// Everything in the Prometheus text format, version 0.0.4.
  [[nodiscard]] std::string prometheus_text() const;

 private:
  struct Series {
    Labels labels;
    std::unique_ptr<Counter> counter;
    std::unique_ptr<Gauge> gauge;
    std::unique_ptr<Histogram> histogram;
  };
  struct Family {
    std::string help;
    const char* type = "";
    std::map<std::string, Series> series;  ///< by label text
  };
  Series& series(const std::string& name, const std::string& help, const char* type,
                 const Labels& labels);

  mutable std::mutex mutex_;
  std::map<std::string, Family> families_;
};

}  // namespace raykiln::server
