// What ESLint holds the pages' modules and their tests to; names that are not defined are TypeScript's to find
// (tsconfig.json).
import js from "@eslint/js";

export default [
  js.configs.recommended,
  {
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "no-undef": "off",
      "no-unused-vars": ["error", { argsIgnorePattern: "^_", varsIgnorePattern: "^_" }],
      eqeqeq: "error",
      "prefer-const": "error",
      "no-var": "error",
      "no-shadow": "error",
      "no-eval": "error",
      "no-implied-eval": "error",
      "no-new-func": "error",
      "no-throw-literal": "error",
      "no-restricted-properties": [
        "error",
        { property: "innerHTML", message: "text that is not ours becomes markup; use textContent or elements" },
        { property: "outerHTML", message: "text that is not ours becomes markup; use elements" },
        { property: "insertAdjacentHTML", message: "text that is not ours becomes markup; use elements" },
      ],
      complexity: ["error", 20],
      "max-lines": ["error", { max: 400, skipBlankLines: true, skipComments: true }],
    },
  },
];
