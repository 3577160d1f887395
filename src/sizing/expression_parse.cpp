// SPDX-License-Identifier: Apache-2.0
// Recursive descent; each level of the grammar binds tighter than the one before:
//   choice      or ? choice : choice
//   or          and || and …
//   and         comparison && comparison …
//   comparison  sum < sum, at most one
//   sum         product + product …
//   product     unary * unary …
//   unary       - unary, or a power
//   power       primary ^ unary
// Depth is counted in choice and unary, through which every recursion passes.
#include <array>
#include <charconv>
#include <cmath>

#include "base/nearest_name.hpp"
#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "sizing/expression_program.hpp"

namespace delfront {
namespace {

using Value = ProgramBuilder::Value;

constexpr std::size_t kLongestText = 20000;
constexpr int kDeepest = 200;

struct Function {
  const char* name;
  int least, most;  ///< arguments
  Operation operation;
};

constexpr int kAnyNumber = 1000000;
/// `choose` stands for those that are put together from several operations.
constexpr Function kFunctions[] = {
    {"abs", 1, 1, Operation::abs},
    {"sqrt", 1, 1, Operation::sqrt},
    {"cbrt", 1, 1, Operation::cbrt},
    {"exp", 1, 1, Operation::exp},
    {"log", 1, 1, Operation::log},
    {"log10", 1, 1, Operation::log10},
    {"sin", 1, 1, Operation::sin},
    {"cos", 1, 1, Operation::cos},
    {"tan", 1, 1, Operation::tan},
    {"asin", 1, 1, Operation::asin},
    {"acos", 1, 1, Operation::acos},
    {"atan", 1, 1, Operation::atan},
    {"sinh", 1, 1, Operation::sinh},
    {"cosh", 1, 1, Operation::cosh},
    {"tanh", 1, 1, Operation::tanh},
    {"floor", 1, 1, Operation::floor},
    {"ceil", 1, 1, Operation::ceil},
    {"sign", 1, 1, Operation::sign},
    {"atan2", 2, 2, Operation::atan2},
    {"pow", 2, 2, Operation::power},
    {"mod", 2, 2, Operation::modulo},
    {"hypot", 2, kAnyNumber, Operation::hypot},
    {"min", 1, kAnyNumber, Operation::minimum},
    {"max", 1, kAnyNumber, Operation::maximum},
    {"step", 2, 2, Operation::choose},
    {"clamp", 3, 3, Operation::choose},
    {"if", 3, 3, Operation::choose},
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Token {
  enum class Kind { end, number, name, string, symbol } kind = Kind::end;
  std::string_view text;  ///< of a string without its quotes
  std::size_t column = 1;
  double value = 0;
};

class Parser {
 public:
  Parser(std::string_view text, ExpressionScope& scope, ProgramBuilder& builder)
      : text_(text), scope_(scope), builder_(builder) {}

  Value parse() {
    if (text_.size() > kLongestText)
      throw UsageError(fmt::format("expression of {} characters: {} at most", text_.size(), kLongestText));
    advance();
    const Value result = choice();
    if (token_.kind != Token::Kind::end) fail_expected("an operator or the end");
    return result;
  }

 private:
  [[noreturn]] void fail(std::size_t column, const std::string& message) const {
    throw UsageError(fmt::format("expression {}, column {}: {}", quoted(text_), column, message));
  }

  [[noreturn]] void fail_expected(const std::string& what) const {
    if (token_.kind == Token::Kind::end) fail(token_.column, fmt::format("expected {}, but the text ends", what));
    const bool follows_value = what.starts_with("an operator");
    std::string hint;
    if (follows_value && (token_.kind == Token::Kind::name || token_.kind == Token::Kind::number || token_.text == "("))
      hint = "; write * between factors (lengths here take no units)";
    if (token_.text == ")" && follows_value) hint = "; there is no ( that it closes";
    fail(token_.column, fmt::format("expected {}, not {}{}", what, quoted(token_.text), hint));
  }

  void advance() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
    token_ = {Token::Kind::end, {}, at_ + 1, 0};
    if (at_ == text_.size()) return;
    const char c = text_[at_];
    const char next = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
    if (is_digit(c) || (c == '.' && is_digit(next))) return read_number();
    if (c == '"' || c == '\'') return read_string(c);
    std::size_t length = 1;
    if (is_letter(c)) {
      while (at_ + length < text_.size() && (is_letter(text_[at_ + length]) || is_digit(text_[at_ + length]))) ++length;
      token_.kind = Token::Kind::name;
    } else {
      length = symbol_length(c);
      token_.kind = Token::Kind::symbol;
    }
    token_.text = text_.substr(at_, length);
    at_ += length;
  }

  std::size_t symbol_length(char c) const {
    const std::string_view two = text_.substr(at_, 2);
    for (const std::string_view symbol : {"<=", ">=", "==", "!=", "&&", "||"})
      if (two == symbol) return 2;
    if (two == "**") fail(at_ + 1, "unknown operator **; a power is a ^ b");
    if (std::string_view("+-*/^<>!?:(),").find(c) != std::string_view::npos) return 1;
    if (c == '=') fail(at_ + 1, "expected ==, not a single =; an expression sets nothing");
    if (c == '&' || c == '|') fail(at_ + 1, fmt::format("expected {0}{0}, not {0}", c));
    if (c == '%') fail(at_ + 1, "unknown operator %; a remainder is mod(a, b), and sizes here take no percent");
    fail(at_ + 1, fmt::format("character {} has no meaning here", quoted(text_.substr(at_, 1))));
  }

  void read_number() {
    const char* const first = text_.data() + at_;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), token_.value);
    const auto length = static_cast<std::size_t>(end - first);
    token_.kind = Token::Kind::number;
    token_.text = text_.substr(at_, length);
    if (error != std::errc{}) fail(token_.column, fmt::format("number {} is out of range", quoted(token_.text)));
    at_ += length;
  }

  void read_string(char quote) {
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail(token_.column, fmt::format("the name after {} has no end", quote));
    token_.kind = Token::Kind::string;
    token_.text = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
  }

  bool accept(std::string_view symbol) {
    if (token_.kind != Token::Kind::symbol || token_.text != symbol) return false;
    advance();
    return true;
  }

  void expect(std::string_view symbol, const std::string& purpose) {
    if (!accept(symbol)) fail_expected(fmt::format("{} {}", symbol, purpose));
  }

  /// Guards every recursion.
  struct Depth {
    explicit Depth(Parser& parser) : depth(parser.depth_) {
      if (++depth > kDeepest) parser.fail(parser.token_.column, fmt::format("nested deeper than {} levels", kDeepest));
    }
    ~Depth() { --depth; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    int& depth;
  };

  Value choice() {
    const Depth guard(*this);
    const Value condition = logical_or();
    if (!accept("?")) return condition;
    const Value if_true = choice();
    expect(":", "and the value if the condition does not hold");
    const Value if_false = choice();
    return builder_.add(Operation::choose, condition, if_true, if_false);
  }

  Value logical_or() {
    Value left = logical_and();
    while (accept("||")) left = builder_.add(Operation::logical_or, left, logical_and());
    return left;
  }

  Value logical_and() {
    Value left = comparison();
    while (accept("&&")) left = builder_.add(Operation::logical_and, left, comparison());
    return left;
  }

  bool is_comparison() const {
    if (token_.kind != Token::Kind::symbol) return false;
    for (const std::string_view symbol : {"<", "<=", ">", ">=", "==", "!="})
      if (token_.text == symbol) return true;
    return false;
  }

  Value comparison() {
    const Value left = sum();
    if (!is_comparison()) return left;
    const std::string_view symbol = token_.text;
    advance();
    const Value right = sum();
    if (is_comparison()) fail(token_.column, "comparisons make no chain: write a < b && b < c");
    if (symbol == "<") return builder_.add(Operation::less, left, right);
    if (symbol == "<=") return builder_.add(Operation::less_equal, left, right);
    if (symbol == ">") return builder_.add(Operation::less, right, left);
    if (symbol == ">=") return builder_.add(Operation::less_equal, right, left);
    return builder_.add(symbol == "==" ? Operation::equal : Operation::not_equal, left, right);
  }

  Value sum() {
    Value left = product();
    for (;;) {
      if (accept("+"))
        left = builder_.add(Operation::add, left, product());
      else if (accept("-"))
        left = builder_.add(Operation::subtract, left, product());
      else
        return left;
    }
  }

  Value product() {
    Value left = unary();
    for (;;) {
      if (accept("*"))
        left = builder_.add(Operation::multiply, left, unary());
      else if (accept("/"))
        left = builder_.add(Operation::divide, left, unary());
      else
        return left;
    }
  }

  Value unary() {
    const Depth guard(*this);
    if (accept("-")) return builder_.add(Operation::negate, unary());
    if (accept("+")) return unary();
    if (accept("!")) return builder_.add(Operation::logical_not, unary());
    const Value base = primary();
    return accept("^") ? builder_.power(base, unary()) : base;
  }

  Value primary() {
    const Token token = token_;
    if (token.kind == Token::Kind::number) {
      advance();
      return builder_.constant(token.value);
    }
    if (token.kind == Token::Kind::name) {
      advance();
      if (accept("(")) return call(token);
      return named_value(token);
    }
    if (accept("(")) {
      const Value inside = choice();
      expect(")", fmt::format("for the ( in column {}", token.column));
      return inside;
    }
    fail_expected("a number, a name or (");
  }

  Value named_value(const Token& token) {
    if (token.text == "x") return builder_.add(Operation::x);
    if (token.text == "y") return builder_.add(Operation::y);
    if (token.text == "z") return builder_.add(Operation::z);
    if (token.text == "pi") return builder_.constant(3.14159265358979323846);
    if (token.text == "e") return builder_.constant(2.71828182845904523536);
    if (token.text == "inf") return builder_.constant(std::numeric_limits<double>::infinity());
    const auto found = scope_.constants().find(std::string(token.text));
    if (found != scope_.constants().end()) return builder_.constant(found->second);
    for (const Function& function : kFunctions)
      if (token.text == function.name) fail(token.column, fmt::format("{0} is a function: write {0}(…)", token.text));
    if (token.text == "distance") fail(token.column, "distance is a function: write distance(\"name\")");
    fail_unknown(token, "name");
  }

  [[noreturn]] void fail_unknown(const Token& token, const char* what) const {
    std::vector<std::string> known{"x", "y", "z", "pi", "e", "inf", "distance"};
    for (const auto& [name, value] : scope_.constants()) known.push_back(name);
    for (const Function& function : kFunctions) known.push_back(function.name);
    const std::string near = nearest_name(token.text, known);
    fail(token.column,
         near.empty() ? fmt::format("unknown {} {}; known are x, y, z, pi, e, inf, constants and functions such as "
                                    "abs, sqrt, exp, min, max, distance",
                                    what, quoted(token.text))
                      : fmt::format("unknown {} {}; did you mean {}?", what, quoted(token.text), near));
  }

  Value call(const Token& name) {
    if (name.text == "distance") return distance();
    for (const Function& function : kFunctions)
      if (name.text == function.name) return call(name, function);
    if (name.text.size() == 1 || scope_.constants().contains(std::string(name.text)))
      fail(name.column, fmt::format("{} is no function; write * between factors", quoted(name.text)));
    fail_unknown(name, "function");
  }

  Value distance() {
    const Token name = token_;
    if (name.kind != Token::Kind::string) fail_expected("a name in quotes, as in distance(\"wing\")");
    advance();
    expect(")", "after the name");
    const int number =
        scope_.distance(std::string(name.text), [&](const std::string& message) { fail(name.column, message); });
    return builder_.add(Operation::distance, 0, 0, 0, number);
  }

  Value call(const Token& name, const Function& function) {
    std::vector<Value> arguments;
    if (token_.text != ")" || token_.kind != Token::Kind::symbol) {
      arguments.push_back(choice());
      while (accept(",")) arguments.push_back(choice());
    }
    if (token_.kind != Token::Kind::symbol || token_.text != ")")
      fail_expected(fmt::format(", or ) after an argument of {}", name.text));
    const auto count = static_cast<int>(arguments.size());
    if (count < function.least || count > function.most) {
      const std::string wanted =
          function.most == kAnyNumber ? fmt::format("{} or more", function.least) : fmt::format("{}", function.least);
      fail(name.column,
           fmt::format("{} takes {} argument{}, not {}", name.text, wanted, wanted == "1" ? "" : "s", count));
    }
    advance();
    return combine(function, arguments);
  }

  Value combine(const Function& function, const std::vector<Value>& arguments) {
    const std::string_view name = function.name;
    if (name == "step") return builder_.add(Operation::less_equal, arguments[0], arguments[1]);
    if (name == "if") return builder_.add(Operation::choose, arguments[0], arguments[1], arguments[2]);
    if (name == "clamp")
      return builder_.add(Operation::minimum, builder_.add(Operation::maximum, arguments[0], arguments[1]),
                          arguments[2]);
    if (name == "pow") return builder_.power(arguments[0], arguments[1]);
    if (function.most == 1) return builder_.add(function.operation, arguments[0]);
    Value result = arguments[0];
    for (std::size_t k = 1; k < arguments.size(); ++k) result = builder_.add(function.operation, result, arguments[k]);
    return result;
  }

  std::string_view text_;
  ExpressionScope& scope_;
  ProgramBuilder& builder_;
  std::size_t at_ = 0;
  Token token_;
  int depth_ = 0;
};

}  // namespace

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 120;
  std::string shown = "'";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f)
      shown += fmt::format("\\x{:02x}", byte);
    else
      shown += c;
  }
  return shown + (text.size() > kLongest ? "…'" : "'");
}

Value parse_expression(std::string_view text, ExpressionScope& scope, ProgramBuilder& builder) {
  return Parser(text, scope, builder).parse();
}

}  // namespace delfront
