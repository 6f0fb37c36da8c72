# Completion of `arena` in bash: eval "$(arena completion bash)"
_arena() {
    local line=${COMP_LINE:0:COMP_POINT} words candidate
    read -ra words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    local word=${words[-1]}
    local before=${word%"${word##*[=:]}"} # to readline it is a word of its own
    COMPREPLY=()
    while IFS= read -r candidate; do
        [[ $candidate == *[=./] ]] || candidate+=" "
        COMPREPLY+=("${candidate#"$before"}")
    done < <("$1" completion candidates "${words[@]:1}" 2>/dev/null)
}
complete -o default -o nospace -F _arena arena
