// Formulas: what a task of troupe.rl observes, rewards and ends, compiled (troupe/rl/formulas.py) to instructions on
// registers. A register has a number for each robot of a world, or, `pairs`, one for each robot and each other one: row
// i has those of robot i. Truth is 0 or 1.
//
// Each world is evaluated by itself, right after its step, while its state is in the cache, by the thread that has
// stepped it. The bits are the same on every machine: sums are in the order of robots, functions are those of
// troupe/deterministic_math.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace troupe::python {

enum class FormulaOp : std::uint8_t {
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kNegate,
  kAbs,
  kSqrt,
  kSin,
  kCos,
  kAtan2,
  kHypot,
  kFloor,
  kWrap,  // an angle to (-pi, pi]
  kMin,
  kMax,
  kLess,
  kAtMost,
  kEqual,
  kNot,
  kAnd,
  kOr,
  kWhere,  // b where a is true, else c
  // Of registers of robots to pairs: the robot's own number, or the other's.
  kOwn,
  kOther,
  // Of pairs to robots, over the others for which b is true: of none 0, infinity, -infinity.
  kSum,
  kLeast,
  kGreatest,
  // Of the grid of cells of 1 m around the middle of W, by x and y: whether the cell has been visited, and whether the
  // robot is the first to visit it, in the order of robots.
  kVisited,
  kVisit,
};
// The names of the operations, for the compiler; in the order of FormulaOp.
std::span<const char* const> FormulaOps();

struct Instruction {
  FormulaOp op = FormulaOp::kAdd;
  std::uint16_t out = 0;
  std::uint16_t a = 0;
  std::uint16_t b = 0;
  std::uint16_t c = 0;
};

// Instructions and the registers of their results.
struct FormulaSection {
  std::vector<Instruction> instructions;
  std::vector<std::uint16_t> results;  // of robots
};

// Registers are in this order: inputs (of robots), memory (of robots), then constants and intermediate results.
struct FormulaProgram {
  std::size_t inputs = 0;
  std::size_t memory = 0;
  std::vector<bool> pairs;                                  // by register
  std::vector<std::pair<std::uint16_t, double>> constants;  // register, number
  FormulaSection start;  // the memory at the start of an episode; the register itself: as it is
  FormulaSection step;   // reward, whether the robot's task has ended, then the memory
  FormulaSection observe;
  std::size_t width = 0;  // cells of the grid
  std::size_t height = 0;

  // Whether all registers exist and have the lanes that their instructions need, so that nothing can be written
  // elsewhere.
  bool IsValid() const;
};

// The registers of one thread. REQUIRES: the program is valid, and lives as long
class FormulaRegisters {
 public:
  FormulaRegisters(const FormulaProgram& program, std::size_t robots);

  std::span<double> of(std::size_t number) { return {data_.data() + first_[number], lanes_[number]}; }
  // `grid`: width * height cells of the world.
  void Run(const FormulaSection& section, std::span<std::uint8_t> grid);

 private:
  void Reduce(const Instruction& instruction);
  void Visit(const Instruction& instruction, std::span<std::uint8_t> grid);

  const FormulaProgram& program_;
  const std::size_t robots_;
  std::vector<std::size_t> first_;  // by register, in data_
  std::vector<std::size_t> lanes_;  // by register
  std::vector<double> data_;
};

}  // namespace troupe::python
